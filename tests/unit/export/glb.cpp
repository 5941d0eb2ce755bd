// SPDX-License-Identifier: MIT
#include "scenes/export/glb.h"
#include "scenes/export/world.h"
#include "tests/support/folder.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

#include <nlohmann/json.hpp>

namespace tandem {
namespace {

using namespace support;
using testing::HasSubstr;
using Json = nlohmann::json;

template<class T>
T number_at(const std::string& bytes, std::size_t at) {
    T value{};
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    return value;
}

/// A parsed .glb file; the constructor checks its structure.
struct Parsed {
    explicit Parsed(const std::string& file) {
        EXPECT_EQ(file.substr(0, 4), "glTF");
        EXPECT_EQ(number_at<std::uint32_t>(file, 4), 2u);
        EXPECT_EQ(number_at<std::uint32_t>(file, 8), file.size());
        const auto length = number_at<std::uint32_t>(file, 12);
        EXPECT_EQ(file.substr(16, 4), "JSON");
        EXPECT_EQ(length % 4, 0u);
        json = Json::parse(file.substr(20, length));
        const auto rest = number_at<std::uint32_t>(file, 20 + length);
        EXPECT_EQ(file.substr(24 + length, 4), std::string("BIN\0", 4));
        EXPECT_EQ(28 + length + rest, file.size());
        binary = file.substr(28 + length);
        EXPECT_EQ(json["buffers"].size(), 1u);
        EXPECT_LE(json["buffers"][0]["byteLength"].get<std::size_t>(), binary.size());
    }

    /// The numbers of an accessor, which must be inside its view, and the view inside the buffer.
    template<class T>
    std::vector<T> numbers(std::size_t index) const {
        const auto& accessor = json.at("accessors").at(index);
        const auto& view = json["bufferViews"].at(accessor["bufferView"].get<std::size_t>());
        const std::map<std::string, std::size_t> widths{{"SCALAR", 1}, {"VEC3", 3}, {"VEC4", 4}};
        const auto count = accessor["count"].get<std::size_t>() * widths.at(accessor["type"]);
        const auto offset = view["byteOffset"].get<std::size_t>();
        EXPECT_EQ(offset % 4, 0u);
        EXPECT_EQ(view["byteLength"].get<std::size_t>(), count * sizeof(T));
        EXPECT_LE(offset + count * sizeof(T), json["buffers"][0]["byteLength"].get<std::size_t>());
        std::vector<T> values(count);
        std::memcpy(values.data(), binary.data() + offset, count * sizeof(T));
        return values;
    }

    Json json;
    std::string binary;
};

/// Checks that minimum and maximum of a float accessor are those of its numbers.
void expect_bounds(const Parsed& glb, std::size_t index) {
    const auto& accessor = glb.json["accessors"].at(index);
    const auto values = glb.numbers<float>(index);
    const auto width = accessor["min"].size();
    EXPECT_EQ(accessor["componentType"], 5126);
    for (std::size_t c = 0; c < width; ++c) {
        float least = values[c], most = values[c];
        for (std::size_t i = c; i < values.size(); i += width) {
            least = std::min(least, values[i]);
            most = std::max(most, values[i]);
        }
        EXPECT_EQ(accessor["min"][c].get<float>(), least);
        EXPECT_EQ(accessor["max"][c].get<float>(), most);
    }
}

/// Signed volume inside a primitive: positive if its triangles wind outward.
double volume_in(const Parsed& glb, const Json& primitive) {
    const auto points = glb.numbers<float>(primitive["attributes"]["POSITION"]);
    const auto corners = glb.numbers<std::uint32_t>(primitive["indices"]);
    const auto point = [&](std::size_t i) {
        EXPECT_LT(corners[i] * 3 + 2, points.size());
        // A shift, because faces through the origin would contribute nothing.
        return (Eigen::Map<const Eigen::Vector3f>(points.data() + corners[i] * 3).cast<double>()
                + Eigen::Vector3d(1, 2, 3))
            .eval();
    };
    double sum = 0;
    for (std::size_t i = 0; i < corners.size(); i += 3) sum += point(i).cross(point(i + 1)).dot(point(i + 2));
    return sum / 6;
}

class ExportGlb : public FolderTest {
protected:
    Parsed exported(const Scene& scene, std::size_t first, std::size_t last) const {
        std::vector<std::size_t> frames;
        for (auto i = first; i <= last; ++i) frames.push_back(i);
        write_glb(path("s.glb"), scene, frames);
        return Parsed(bytes_of(path("s.glb")));
    }
};

TEST_F(ExportGlb, EveryBodyIsANodeOfASurface) {
    auto scene = crowd(5, 9, 3);
    const auto glb = exported(scene, 1, 1);
    EXPECT_EQ(glb.json["asset"]["version"], "2.0");
    EXPECT_FALSE(glb.json.contains("animations"));
    ASSERT_EQ(glb.json["nodes"].size(), 9u);
    EXPECT_EQ(glb.json["scenes"][0]["nodes"].size(), 9u);
    const auto frame = scene.frame(1);
    for (std::size_t b = 0; b < 9; ++b) {
        const auto& node = glb.json["nodes"][b];
        const auto& mesh = glb.json["meshes"].at(node["mesh"].get<std::size_t>());
        const auto& primitive = mesh["primitives"][0];
        EXPECT_LT(primitive["material"].get<std::size_t>(), glb.json["materials"].size());
        expect_bounds(glb, primitive["attributes"]["POSITION"]);
        auto own = scene.meshes[scene.bodies[b].mesh];
        EXPECT_EQ(node.contains("translation"), b != 1);
        if (b == 1)
            own.vertices = frame.deformed[1];
        else
            EXPECT_EQ(node["translation"][2].get<double>(), frame.poses[b].translation.z());
        EXPECT_NEAR(volume_in(glb, primitive), volume(own), 1e-5);
    }
    // Bodies 3 and 6 share a mesh, and therefore the numbers of its surface, but not a colour.
    EXPECT_LT(glb.json["meshes"].size(), 9u);
    EXPECT_EQ(glb.json["accessors"].size(), 2u * 4);
}

TEST_F(ExportGlb, SurfacesOfInvertedTetrahedraWindOutward) {
    Random random(3);
    auto mesh = shaken_box(2, random);
    const auto expected = exporting::surface_of(mesh);
    for (auto& t : mesh.tetrahedra) std::swap(t[2], t[3]);
    complete_mesh(mesh, "inverted");
    const auto surface = exporting::surface_of(mesh);
    EXPECT_EQ(mesh.inverted, 24u); // those that were not inverted before
    EXPECT_EQ(expected.triangles.size(), 3u * 6 * 4 * 2);
    EXPECT_EQ(surface.vertices, expected.vertices);
    EXPECT_EQ(surface.vertices.size(), 26u); // all but the inner one
    double sum = 0;
    for (std::size_t i = 0; i < surface.triangles.size(); i += 3) {
        const auto at = [&](std::size_t j) {
            return mesh.vertices[surface.vertices[surface.triangles[i + j]]];
        };
        sum += at(0).cross(at(1)).dot(at(2)) / 6;
    }
    EXPECT_NEAR(sum, volume(mesh), 1e-12);
}

TEST_F(ExportGlb, PosesBecomeAnAnimation) {
    const auto scene = make_scene("pile:bodies=4,frames=7");
    const auto glb = exported(scene, 2, 6);
    ASSERT_EQ(glb.json["animations"].size(), 1u);
    const auto& animation = glb.json["animations"][0];
    ASSERT_EQ(animation["channels"].size(), 8u);
    for (const auto& channel : animation["channels"]) {
        const auto& sampler = animation["samplers"].at(channel["sampler"].get<std::size_t>());
        expect_bounds(glb, sampler["input"]);
        EXPECT_EQ(glb.numbers<float>(sampler["input"]), (std::vector<float>{0, 0.04f, 0.08f, 0.12f, 0.16f}));
        const auto body = channel["target"]["node"].get<std::size_t>();
        const bool turns = channel["target"]["path"] == "rotation";
        const std::size_t width = turns ? 4 : 3;
        const auto values = glb.numbers<float>(sampler["output"]);
        ASSERT_EQ(values.size(), 5 * width);
        for (std::size_t i = 0; i < 5; ++i) {
            const auto pose = scene.frame(2 + i).poses[body];
            if (turns) {
                const Eigen::Vector4f q = pose.rotation.coeffs().cast<float>();
                const Eigen::Map<const Eigen::Vector4f> key(values.data() + i * 4);
                EXPECT_TRUE(key == q || key == -q);
            } else {
                EXPECT_EQ(values[i * 3 + 1], static_cast<float>(pose.translation.y()));
            }
        }
    }
}

TEST_F(ExportGlb, DeformableBodiesMorph) {
    const auto scene = crowd(5, 3, 3);
    write_glb(path("s.glb"), scene, std::vector<std::size_t>{1, 0, 1});
    const Parsed glb(bytes_of(path("s.glb")));
    const auto& mesh = glb.json["meshes"][glb.json["nodes"][1]["mesh"].get<std::size_t>()];
    const auto& primitive = mesh["primitives"][0];
    EXPECT_EQ(mesh["weights"], (std::vector<double>{0, 0}));
    ASSERT_EQ(primitive["targets"].size(), 2u);
    const auto first = glb.numbers<float>(primitive["attributes"]["POSITION"]);
    const auto surface = exporting::surface_of(scene.meshes[1]);
    for (std::size_t target = 0; target < 2; ++target) {
        const std::size_t accessor = primitive["targets"][target]["POSITION"];
        expect_bounds(glb, accessor);
        const auto moved = glb.numbers<float>(accessor);
        const auto expected = exporting::points_of(surface, scene.frame(target).deformed[1]);
        ASSERT_EQ(moved.size(), expected.size());
        for (std::size_t i = 0; i < moved.size(); ++i) EXPECT_NEAR(first[i] + moved[i], expected[i], 1e-6);
    }
    // One channel for the deformable body, two for the rigid one, none for the fixed one.
    const auto& animation = glb.json["animations"][0];
    ASSERT_EQ(animation["channels"].size(), 3u);
    EXPECT_EQ(animation["channels"][0]["target"], (Json{{"node", 1}, {"path", "weights"}}));
    EXPECT_EQ(glb.numbers<float>(animation["samplers"][0]["output"]), (std::vector<float>{0, 0, 1, 0, 0, 1}));
    EXPECT_EQ(animation["channels"][2]["target"]["node"], 2);
}

TEST_F(ExportGlb, TooManyFramesAreRefusedBeforeAnyIsMade) {
    auto scene = crowd(5, 3, 3);
    scene.frame = [](std::size_t) -> Frame { throw std::logic_error("asked for a frame"); };
    const std::vector<std::size_t> frames(40000);
    EXPECT_THAT(message_of([&] { write_glb(path("s.glb"), scene, frames); }),
                HasSubstr("bytes, but glTF allows at most 4294967295; export fewer frames"));
}

TEST_F(ExportGlb, TimesAreThoseOfTheScene) {
    auto scene = make_scene("pile:bodies=2,frames=4");
    const auto times = [&] {
        const auto glb = exported(scene, 1, 3);
        return glb.numbers<float>(glb.json["animations"][0]["samplers"][0]["input"]);
    };
    scene.time = [](std::size_t i) { return 10 + 0.5 * static_cast<double>(i * i); };
    EXPECT_EQ(times(), (std::vector<float>{0, 1.5f, 4}));
    scene.time = [](std::size_t) { return 1.0; };
    EXPECT_EQ(times(), (std::vector<float>{0, 0.04f, 0.08f}));
    EXPECT_THAT(message_of([&] { write_glb(path("no/s.glb"), scene, std::vector<std::size_t>{0}); }),
                HasSubstr("cannot be written"));
}

TEST_F(ExportGlb, NeighbouringKeysRotateTheShortWay) {
    auto scene = make_scene("pile:bodies=2,frames=4");
    scene.frame = [inner = scene.frame](std::size_t i) {
        auto frame = inner(i);
        if (i % 2 == 1) frame.poses[0].rotation.coeffs() *= -1;
        return frame;
    };
    const auto glb = exported(scene, 0, 3);
    const auto keys = glb.numbers<float>(glb.json["animations"][0]["samplers"][1]["output"]);
    for (std::size_t i = 4; i < 16; i += 4)
        EXPECT_GT(
            Eigen::Map<const Eigen::Vector4f>(&keys[i]).dot(Eigen::Map<const Eigen::Vector4f>(&keys[i - 4])),
            0);
}

} // namespace
} // namespace tandem
