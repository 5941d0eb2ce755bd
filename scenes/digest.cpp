// SPDX-License-Identifier: MIT
#include "scenes/digest.h"

#include <bit>

namespace tandem {

namespace {

/// FNV-1a (Fowler, Noll and Vo) over 64-bit words with a final mix for each, so that high bits count too.
class Digester {
public:
    void add(std::uint64_t word) {
        state_ = (state_ ^ word) * 0x100000001b3u;
        state_ ^= state_ >> 32;
    }
    void add(double number) { add(std::bit_cast<std::uint64_t>(number + 0.0)); } // -0 is 0
    /// With its length, so that two texts in a row differ from one.
    void add(std::string_view text) {
        add(std::uint64_t{text.size()});
        for (const char c : text) add(std::uint64_t{static_cast<unsigned char>(c)});
    }
    void add(const Eigen::Vector3d& v) {
        for (const double x : v) add(x);
    }
    std::uint64_t value() const { return state_; }

private:
    std::uint64_t state_ = 0xcbf29ce484222325u;
};

void add(Digester& digester, const Mesh& mesh) {
    digester.add(std::uint64_t{mesh.vertices.size()});
    for (const auto& v : mesh.vertices) digester.add(v);
    for (const auto& t : mesh.tetrahedra)
        for (const auto vertex : t) digester.add(std::uint64_t{vertex});
}

void add(Digester& digester, const Frame& frame) {
    for (const auto& pose : frame.poses) {
        for (const double x : pose.rotation.coeffs()) digester.add(x);
        digester.add(pose.translation);
    }
    for (const auto& vertices : frame.deformed)
        for (const auto& v : vertices) digester.add(v);
}

} // namespace

std::uint64_t digest_of(std::string_view text) {
    Digester digester;
    digester.add(text);
    return digester.value();
}

std::uint64_t digest_of(const Frame& frame) {
    Digester digester;
    add(digester, frame);
    for (const auto& list : frame.skipped) {
        digester.add(std::uint64_t{list.size()});
        for (const auto tetrahedron : list) digester.add(std::uint64_t{tetrahedron});
    }
    return digester.value();
}

std::uint64_t digest_of(const Scene& scene) {
    Digester digester;
    digester.add(scene.key);
    for (const auto& mesh : scene.meshes) add(digester, mesh);
    for (const auto& body : scene.bodies)
        digester.add(std::uint64_t{body.mesh} << 2 | (body.fixed ? 1u : 0u) | (body.deformable ? 2u : 0u));
    add(digester, scene.frame(0));
    add(digester, scene.frame(scene.frame_count - 1));
    return digester.value();
}

} // namespace tandem
