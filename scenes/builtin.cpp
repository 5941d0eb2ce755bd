// SPDX-License-Identifier: MIT
#include "scenes/builtin.h"

#include "scenes/embedded.h"
#include "base/error.h"
#include "scenes/read/read.h"

namespace tandem {

std::span<const std::string> built_in_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> result;
        for (const auto& mesh : embedded_meshes()) result.emplace_back(mesh.name);
        return result;
    }();
    return names;
}

Mesh built_in_mesh(std::string_view name) {
    for (const auto& embedded : embedded_meshes()) {
        if (embedded.name != name) continue;
        auto mesh =
            parse_tetgen(embedded.node, embedded.name + ".node", embedded.ele, embedded.name + ".ele");
        mesh.name = name;
        complete_mesh(mesh, embedded.name);
        return mesh;
    }
    throw InputError(unknown("mesh", name, built_in_names()));
}

} // namespace tandem
