// SPDX-License-Identifier: MIT
// nvrtc [--require nvrtc]: compiles every kernel of the plan with NVRTC, without a GPU: all define sets for
// sm_90, the defaults for the other architectures. Without NVRTC it prints the number of kernels not
// compiled.
#include "algorithms/bodies/pack_stage.h"
#include "algorithms/answer/pair_list.h"
#include "tests/support/prepared_trees.h"
#include "algorithms/kernels/sources.h"
#include "algorithms/traversal.h"
#include "backends/ptxas_log.h"
#include "scenes/builtin.h"
#include "tests/nvrtc/budget.h"
#include "tests/nvrtc/compiling_device.h"
#include "tests/support/contact_rules.h"
#include "tests/support/folder.h"
#include "tests/support/long_form.h"
#include "tests/support/scenes.h"

#include <algorithm>
#include <atomic>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mutex>
#include <optional>
#include <thread>

namespace tandem {
namespace {

bool required = false;

using Programs = std::map<std::pair<std::string, Defines>, std::set<std::string>>;

/// Opens NVRTC once. Without NVRTC the result is empty, and a message names the untested part.
const std::optional<cuda::Nvrtc>& nvrtc() {
    static const auto compiler = []() -> std::optional<cuda::Nvrtc> {
        try {
            return cuda::Nvrtc();
        } catch (const DeviceError& error) {
            fmt::print("{}\n", error.what());
            return std::nullopt;
        }
    }();
    return compiler;
}

/// The image of a program for sm_90, cached for all tests because compilation takes almost all of their time.
const cuda::Image& for_hopper(const KernelSource& source, const Defines& defines) {
    static std::map<std::pair<std::string, Defines>, cuda::Image> images;
    static std::mutex mutex;
    const std::pair key{std::string(source.name), defines};
    {
        const std::lock_guard lock(mutex);
        if (const auto known = images.find(key); known != images.end()) return known->second;
    }
    auto image = nvrtc()->compile(source, defines, 90);
    const std::lock_guard lock(mutex);
    return images.try_emplace(key, std::move(image)).first->second;
}

/// Compiles the kernels that sessions with the given settings request.
void prepare(Device& device, const Traversal& traversal, std::span<const Assignment> from,
             const SettingTexts& given) {
    auto scene = make_scene("pile:bodies=2,frames=1");
    support::set_pressures(scene);
    const auto settings = resolve(traversal.parameters(), from, given, traversal.name());
    const std::array devices{&device};
    const auto session = traversal.prepare(devices, scene, settings);
    session->count_work(true);
}

/// Compiles the test of an explicit pair list, and the packing of frames in device memory.
void prepare_pair_list(Device& device, Precision precision) {
    const auto scene = make_scene("hard:touch:pairs=2,together=2");
    const support::PreparedTrees on_device(device, scene, {.precision = precision}, 32, 128);
    const PairList list(on_device.trees, std::vector<Pair>{{0, 0, 1, 0}, {0, 1, 1, 1}});
    const PackStage pack(on_device.bodies, {128, 1});
}

/// Rule sat with every decision. In long form also every other rule, without verdicts and with them.
void prepare_contacts(Device& device) {
    const auto& traversal = algorithm("chunked");
    for (const std::string precision : {"float", "double"})
        for (const auto& [rule, word] : support::contact_rules())
            for (const std::string decision : {"fp32", "recheck", "fp64", "exact"})
                if (rule == ContactRule::sat
                    || (support::long_form() && (decision == "fp32" || decision == "recheck")))
                    prepare(device, traversal, traversal.presets().front().values,
                            {{"precision", precision}, {"contact_rule", word}, {"decision", decision}});
}

/// One tree over all bodies, in both precisions.
void prepare_scene_tree(Device& device, const std::string& k) {
    for (const std::string precision : {"float", "double"})
        prepare(device, algorithm("leaf_query"), {}, {{"tree", "scene"}, {"k", k}, {"precision", precision}});
}

/// The plan: every geometry and contact rule with the first preset of every algorithm; every rounding and
/// placement with all directions in float; every preset and output with its own settings.
Programs plan() {
    CompilingDevice device;
    prepare_contacts(device);
    for (const auto* traversal : algorithms()) {
        const auto& first = traversal->presets().front().values;
        for (const std::string precision : {"float", "double"}) {
            for (const std::string k : {"6", "8", "8c", "12", "14", "16", "18", "20", "24", "26"})
                prepare(device, *traversal, first,
                        {{"k", k.substr(0, k.find('c'))},
                         {"axes", k == "8c" ? "coordinate" : "standard"},
                         {"precision", precision}});
        }
        for (const auto& [rounding, placement] :
             {std::pair{"nearest", "rounded"}, std::pair{"published", "rounded"},
              std::pair{"directed", "rounded"}, std::pair{"safe", "exact"}, std::pair{"directed", "exact"}})
            prepare(device, *traversal, first,
                    {{"k", "26"}, {"rounding", rounding}, {"placement", placement}});
        for (const auto& preset : traversal->presets())
            for (const std::string output : {"pairs", "count", "digest"})
                prepare(device, *traversal, preset.values, {{"output", output}});
    }
    for (const std::string k : {"6", "8", "18", "26"}) prepare_scene_tree(device, k);
    for (const auto precision : {Precision::fp32, Precision::fp64}) prepare_pair_list(device, precision);
    return device.requested();
}

Programs defaults() {
    CompilingDevice device;
    for (const auto* traversal : algorithms())
        for (const std::string precision : {"float", "double"})
            prepare(device, *traversal, traversal->presets().front().values, {{"precision", precision}});
    prepare_scene_tree(device, "18");
    for (const std::string most_seeds : {"1", "16384"}) // start at tops, and below them
        prepare(device, algorithm("tiled"), {}, {{"most_seeds", most_seeds}});
    for (const std::string k : {"6", "18"})
        prepare(device, algorithm("tiled"), {}, {{"k", k}, {"self", "on"}});
    for (const auto precision : {Precision::fp32, Precision::fp64}) prepare_pair_list(device, precision);
    return device.requested();
}

/// Runs `work` for all programs on all cores.
template<class Work>
void for_each(const Programs& programs, const Work& work) {
    std::vector<const Programs::value_type*> list;
    for (const auto& program : programs) list.push_back(&program);
    std::atomic<std::size_t> next = 0;
    std::vector<std::jthread> threads;
    for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i)
        threads.emplace_back([&] {
            for (auto n = next++; n < list.size(); n = next++) {
                try {
                    work(kernel_source(list[n]->first.first), list[n]->first.second, list[n]->second);
                } catch (const DeviceError& error) {
                    ADD_FAILURE() << error.what();
                }
            }
        });
}

std::string text_of(const Defines& defines) {
    std::string text;
    for (const auto& [name, value] : defines) text += fmt::format(" {}={}", name, value);
    return text;
}

/// False, with a message, without NVRTC.
bool can_compile(const Programs& programs) {
    if (nvrtc()) return true;
    fmt::print("NOT compiled, no NVRTC: {} kernel programs\n", programs.size());
    EXPECT_FALSE(required) << "--require nvrtc";
    return false;
}

TEST(Nvrtc, EveryProgramOfThePlanForHopperOnlyLong) {
    const auto programs = plan();
    ASSERT_GT(programs.size(), 100u);
    if (!can_compile(programs)) return;
    std::atomic<int> entries = 0;
    for_each(programs,
             [&](const KernelSource& source, const Defines& defines, const std::set<std::string>& names) {
                 const auto& image = for_hopper(source, defines);
                 EXPECT_EQ(image.target, "sm_90 cubin");
                 EXPECT_GT(image.bytes.size(), 1000u) << source.name;
                 for (const auto& name : names) {
                     const auto use = use_of(image.log, name);
                     EXPECT_GT(use.registers, 0) << name << "\n" << image.log;
                     EXPECT_GE(use.spill_bytes, 0) << name;
                     ++entries;
                 }
             });
    fmt::print("{} programs, {} entries compiled for sm_90 by NVRTC {}\n", programs.size(), entries.load(),
               nvrtc()->version());
}

/// Registers and spills of the float defaults, which decide the speed. The budget leaves half of the 2048
/// work-items of an sm_90 multiprocessor (64 registers each). It is a third for the traversal with nodes in
/// registers; 28 warps for the one with boxes in registers, whose rows in local memory limit it to that
/// number; a quarter for contacts. Builds that count work are never timed and have no budget.
TEST(Nvrtc, DefaultFloatKernelsKeepTheirBudgetLong) {
    const auto programs = defaults();
    if (!can_compile(programs)) return;
    for (const auto& [key, names] : programs) {
        const auto& [file, defines] = key;
        const auto is = [&defines = defines](const std::string& name, const std::string& value) {
            return defines.contains(name) && defines.at(name) == value;
        };
        const bool budgeted = !is_double(defines) && !is("COUNT_WORK", "1");
        if (!budgeted && !support::long_form()) continue; // only printed
        const auto& image = for_hopper(kernel_source(file), defines);
        for (const auto& name : names) {
            const auto use = use_of(image.log, name);
            fmt::print("{:<40} {:<20} {:>3} registers {:>4} bytes spilled{}\n", file, name, use.registers,
                       use.spill_bytes, is_double(defines) ? " (double)" : "");
            if (!budgeted) continue;
            const int budget = name == "generate_contacts"    ? 128
                               : name == "separate_pairs"     ? 96
                               : name == "certify_pairs"      ? 80
                               : name == "traverse_in_groups" ? 96
                               : name == "walk_leaf_tiles"    ? 72
                               : name == "walk_upper_tiles"   ? 72
                                                              : 64;
            EXPECT_LE(use.registers, budget) << name;
            EXPECT_EQ(use.spill_bytes, 0) << name;
        }
    }
}

TEST(Nvrtc, ContactRulesAndDecisionsKeepTheirBudgetOnlyLong) {
    CompilingDevice device;
    prepare_contacts(device);
    if (!can_compile(device.requested())) return;
    for_each(device.requested(), [&](const KernelSource& source, const Defines& defines,
                                     const std::set<std::string>& names) {
        const auto& image = for_hopper(source, defines);
        for (const auto& name : names) {
            const auto most = budget_of(name, defines);
            if (!most) continue;
            const auto use = use_of(image.log, name);
            EXPECT_LE(use.registers, most->registers) << name << text_of(defines);
            EXPECT_GE(use.stack_bytes, 0) << name << text_of(defines);
            EXPECT_GE(use.spill_bytes, 0) << name << text_of(defines);
            EXPECT_LE(use.stack_bytes + use.spill_bytes, most->private_bytes) << name << text_of(defines);
        }
    });
    std::set<std::string> seen;
    for (const auto& [program, names] : device.requested())
        for (const auto& name : names)
            if (budget_of(name, program.second)) seen.insert(name);
    EXPECT_EQ(seen.size(), 5u);
}

/// Private arrays are in device memory: they were most of the stage's traffic.
TEST(Nvrtc, ContactsByBoundaryFacesHaveNoStack) {
    CompilingDevice device;
    for (const std::string rule : {"opposing", "published"})
        prepare(device, algorithm("chunked"), {}, {{"contact_rule", rule}});
    if (!can_compile(device.requested())) return;
    std::atomic<int> checked = 0;
    for (const int architecture : {80, 90})
        for_each(device.requested(),
                 [&](const KernelSource& source, const Defines& defines, const std::set<std::string>& names) {
                     if (!defines.contains("CONTACT_RULE")) return;
                     const auto log = nvrtc()->compile(source, defines, architecture).log;
                     for (const auto& name : names) {
                         const auto use = use_of(log, name);
                         EXPECT_EQ(use.stack_bytes, 0) << name << text_of(defines);
                         EXPECT_EQ(use.spill_bytes, 0) << name << text_of(defines);
                         ++checked;
                     }
                 });
    EXPECT_EQ(checked, 2 * 2 * 4); // certify_pairs, separate_pairs and generate_contacts, also at once
}

/// Without the instructions that a kernel's text contains itself.
std::string chosen_by_compiler(std::string_view ptx) {
    constexpr std::string_view begin = "// begin inline asm", end = "// end inline asm";
    std::string rest;
    for (auto at = ptx.find(begin); at != std::string_view::npos; at = ptx.find(begin)) {
        rest += ptx.substr(0, at);
        ptx.remove_prefix(ptx.find(end, at) + end.size());
    }
    return rest.append(ptx);
}

TEST(Nvrtc, NoFusedMultiplyAddLong) {
    const auto programs = defaults();
    if (!can_compile(programs)) return;
    for_each(programs, [&](const KernelSource& source, const Defines& defines, const std::set<std::string>&) {
        const auto counting = defines.find("COUNT_WORK");
        const bool counts = counting != defines.end() && counting->second == "1";
        if (counts && !support::long_form()) return; // its operations are those of the other build
        const auto ptx = nvrtc()->compile(source, defines, 90, true).bytes;
        EXPECT_NE(ptx.find(".visible .entry"), std::string::npos);
        EXPECT_EQ(chosen_by_compiler(ptx).find("fma.rn.f"), std::string::npos)
            << source.name << text_of(defines);
    });
}

TEST(Nvrtc, DirectedSlabsRoundDownAndUp) {
    CompilingDevice device;
    const auto& chunked = algorithm("chunked");
    for (const std::string precision : {"float", "double"})
        prepare(device, chunked, {}, {{"k", "26"}, {"rounding", "directed"}, {"precision", precision}});
    if (!can_compile(device.requested())) return;
    int checked = 0;
    for (const auto& [program, names] : device.requested()) {
        if (!names.contains("refit_strips")) continue;
        const auto ptx = nvrtc()->compile(kernel_source(program.first), program.second, 90, true).bytes;
        const std::string type = program.second.at("PRECISION") == "64" ? "f64" : "f32";
        EXPECT_NE(ptx.find("add.rm." + type), std::string::npos);
        EXPECT_NE(ptx.find("add.rp." + type), std::string::npos);
        ++checked;
    }
    EXPECT_EQ(checked, 2);
}

TEST(Nvrtc, DefaultsForEveryArchitectureOnlyLong) {
    const auto programs = defaults();
    if (!can_compile(programs)) return;
    const auto& known = nvrtc()->architectures();
    for (const int architecture : {75, 80, 86, 89, 100, 120}) {
        if (std::find(known.begin(), known.end(), architecture) == known.end()) {
            fmt::print("NVRTC {} does not know {}; not compiled\n", nvrtc()->version(), architecture);
            continue;
        }
        for_each(programs,
                 [&](const KernelSource& source, const Defines& defines, const std::set<std::string>&) {
                     EXPECT_GT(nvrtc()->compile(source, defines, architecture).bytes.size(), 1000u);
                 });
    }
}

TEST(Nvrtc, AnUnknownNewerArchitectureGetsPtx) {
    if (!can_compile(defaults())) return;
    const auto image = nvrtc()->compile(kernel_source("algorithms/answer/digest.cl"), {},
                                        nvrtc()->architectures().back() + 10);
    EXPECT_NE(image.target.find(" ptx"), std::string::npos);
    EXPECT_NE(image.bytes.find(".version"), std::string::npos);
    EXPECT_THROW(nvrtc()->compile(kernel_source("algorithms/answer/digest.cl"), {}, 10), DeviceError);
}

using NvrtcCache = support::FolderTest;

/// Cached images equal newly compiled ones; source, defines and architecture distinguish them.
TEST_F(NvrtcCache, CachedImagesBelongToTheirProgram) {
    if (!can_compile(defaults())) return;
    const KernelSource one{"one.cl", "extern \"C\" __global__ void f(int* a) { *a = K; }\n"};
    const KernelSource other{"one.cl", "extern \"C\" __global__ void f(int* a) { *a = K + 10; }\n"};
    const auto all = [&](const cuda::Nvrtc& compiler) {
        return std::vector{compiler.compile(one, {{"K", "8"}}, 90), compiler.compile(one, {{"K", "9"}}, 90),
                           compiler.compile(other, {{"K", "8"}}, 90), compiler.compile(one, {{"K", "8"}}, 80),
                           compiler.compile(one, {{"K", "8"}}, 90, true)};
    };
    const auto expected = all(cuda::Nvrtc(0, ""));
    EXPECT_EQ(std::set<std::string>({expected[0].bytes, expected[1].bytes, expected[2].bytes,
                                     expected[3].bytes, expected[4].bytes})
                  .size(),
              5u);
    const auto made = all(cuda::Nvrtc(0, path("images"))), kept = all(cuda::Nvrtc(0, path("images")));
    EXPECT_TRUE(made == kept);
    for (std::size_t i = 0; i < kept.size(); ++i) {
        EXPECT_EQ(kept[i].bytes, expected[i].bytes);
        EXPECT_EQ(kept[i].target, expected[i].target); // logs contain times
    }
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(path("images")), {}), 5);
}

TEST(Nvrtc, ErrorsHaveTheLogInOneLine) {
    if (!can_compile(defaults())) return;
    const KernelSource broken{"broken.cl", "KERNEL void nothing(\n"};
    try {
        nvrtc()->compile(broken, {{"K", "8"}}, 90);
        FAIL();
    } catch (const DeviceError& error) {
        const std::string text = error.what();
        EXPECT_NE(text.find("broken.cl does not compile with NVRTC"), std::string::npos);
        EXPECT_NE(text.find("-DK=8"), std::string::npos);
        EXPECT_NE(text.find("error"), std::string::npos);
        EXPECT_EQ(text.find('\n'), std::string::npos);
    }
}

} // namespace
} // namespace tandem

int main(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    tandem::required = argc == 3 && std::string(argv[1]) == "--require" && std::string(argv[2]) == "nvrtc";
    if (argc > 1 && !tandem::required) {
        fmt::print(stderr, "test_nvrtc [--require nvrtc]\n");
        return 2;
    }
    return RUN_ALL_TESTS();
}
