// SPDX-License-Identifier: MIT
// The settings of several algorithms: name, default, choices or range, define and help. Settings of a single
// algorithm have the same form, in its own file.
#pragma once

#include "algorithms/parameters/choices.h"
#include "algorithms/parameters/parameter.h"

#include <limits>

namespace tandem::parameters {

inline constexpr std::int64_t word_limit = std::numeric_limits<std::uint32_t>::max();

inline constexpr auto k =
    Setting<int>{"k",
                 18,
                 {{"6", 6},
                  {"8", 8},
                  {"12", 12},
                  {"14", 14},
                  {"16", 16},
                  {"18", 18},
                  {"20", 20},
                  {"24", 24},
                  {"26", 26}},
                 "K",
                 "planes of the k-DOPs (k/2 directions); auto varies it only with decision=exact and "
                 "output=contacts, where it changes no contact"}
        .with_alternatives({6, 18});
inline constexpr Setting<Axes> axes{
    "axes",
    Axes::standard,
    {{"standard", Axes::standard}, {"coordinate", Axes::coordinate}},
    "AXES",
    "k=8: standard = the paper's four cube diagonals, coordinate = x, y, z and one diagonal"};
inline constexpr Setting<Precision> precision{"precision",
                                              Precision::fp32,
                                              {{"float", Precision::fp32}, {"double", Precision::fp64}},
                                              "PRECISION",
                                              "type of reals in vertices, slabs and contacts"};
inline constexpr Setting<Rounding> rounding{
    "rounding",
    Rounding::safe,
    {{"nearest", Rounding::nearest},
     {"safe", Rounding::safe},
     {"published", Rounding::published},
     {"directed", Rounding::directed}},
    "ROUNDING",
    "safe widens diagonal slabs by their rounding bound: nothing is missed; published: unit directions, a "
    "fixed tolerance, as the paper's code; directed (CUDA): slabs contain the exact ones"};
inline constexpr Setting<Placement> placement{
    "placement",
    Placement::rounded,
    {{"rounded", Placement::rounded}, {"exact", Placement::exact}},
    "PLACEMENT",
    "vertices whose contacts no slab misses: rounded: the world vertices after rounding; exact: the scene's "
    "vertices, transformed exactly by its poses (rounding=safe and directed, wider slabs)"};
inline constexpr Setting<Motion> motion{
    "motion",
    Motion::none,
    {{"none", Motion::none}, {"linear", Motion::linear}},
    "MOTION",
    "positions that bounds contain: none: those of the frame; linear: all between the frame and its "
    "successor, so that no pair that meets on the way is missed; contacts are those of the frame"};
inline constexpr Setting<double> margin{
    "margin", 1e30, "",
    "distance within which no pair of tetrahedra is missed, in the scene's unit of length (rounding=safe and "
    "directed): bounds grow by half of it in all directions"};
inline constexpr Setting<bool> pressure_slab{
    "pressure_slab",
    false,
    {{"off", false}, {"on", true}},
    "PRESSURE_SLAB",
    "contact_rule=pressure: whether nodes also bound pressures, so that walks leave out pairs of tetrahedra "
    "without a common pressure, which have no polygon; on host with k=18 only"};
inline constexpr Setting<Origin> origin{
    "origin",
    Origin::automatic,
    {{"world", Origin::world}, {"auto", Origin::automatic}},
    "",
    "origin of coordinates on devices: auto: a point in the middle of the scene's first frame, and rigid "
    "meshes far from their own origin are centred, so that a scene far from the world's origin is as "
    "accurate "
    "as one near it; world: the world's origin. auto is world where neither changes anything, and for "
    "placement=exact with precision=double"};

inline constexpr auto builder =
    Setting<Builder>{
        "builder",
        Builder::morton,
        {{"morton", Builder::morton},
         {"sah", Builder::sah},
         {"breadth", Builder::breadth},
         {"hilbert", Builder::hilbert},
         {"median", Builder::median},
         {"balanced", Builder::balanced}},
        "",
        "order of a body's tetrahedra, from which trees are made: morton: along the Z-curve, as "
        "the paper; sah: cut by the surface area heuristic into runs of 32, 32^2, ...; breadth: "
        "breadth-first from face to face, which the paper tried first; hilbert: along Hilbert's "
        "curve; median: halved along the longest axis, at such runs; balanced: cut where one complete "
        "binary tree over the body cuts, along the axis of the smallest surfaces"}
        .with_alternatives({Builder::morton, Builder::sah});
inline constexpr auto slabs =
    Setting<Slabs>{
        "slabs",
        Slabs::usual,
        {{"three", Slabs::three}, {"all", Slabs::all}, {"touched", Slabs::touched}, {"usual", Slabs::usual}},
        "SLABS",
        "directions with bounds in leaves: three: three of the k/2, with tests along the rest from "
        "the vertices of pairs that pass; all; touched: all, made only for tiles that the walk "
        "touches if the last frame touched few; usual: all up to k = 12, touched above, and three "
        "where touched would take a quarter of the device's memory"}
        .with_alternatives({Slabs::all});

#define TANDEM_CHOICE(word, traits, help) {#word, ContactRule::word},
#define TANDEM_HELP(word, traits, help) #word ": " help "; "
inline constexpr Setting<ContactRule> contact_rule{
    "contact_rule",
    ContactRule::opposing,
    {TANDEM_CONTACT_RULES(TANDEM_CHOICE){"none", ContactRule::none}},
    "CONTACT_RULE",
    TANDEM_CONTACT_RULES(TANDEM_HELP) "none: no contacts. opposing and published depend on the order of the "
                                      "two bodies: some pairs have contacts in one order only"};
#undef TANDEM_CHOICE
#undef TANDEM_HELP
inline constexpr Setting<DecisionPrecision> decision{
    "decision",
    DecisionPrecision::fp32,
    {{"fp32", DecisionPrecision::fp32},
     {"recheck", DecisionPrecision::recheck},
     {"fp64", DecisionPrecision::fp64},
     {"exact", DecisionPrecision::exact},
     {"none", DecisionPrecision::none},
     {"usual", DecisionPrecision::usual}},
    "",
    "how to decide whether a pair collides: fp32: separating axes in the cell's precision; recheck: a "
    "certified filter, then double; fp64: double; exact: as recheck, then exact arithmetic on the host; "
    "none: no pair is rejected, as in the paper's code; of contact_rule=pressure, polygons decide; usual: "
    "recheck, but exact with motion=linear, and "
    "fp32 "
    "on a device without double"};

inline constexpr Setting<Broad> broad{
    "broad",
    Broad::sphere,
    {{"sphere", Broad::sphere},
     {"sphere_boxes", Broad::sphere_boxes},
     {"tight", Broad::tight},
     {"device", Broad::device}},
    "",
    "how to find body pairs: sphere: on the host, by spheres; sphere_boxes: on the host, by axis-aligned "
    "boxes of spheres, as the paper's release, which leaves out candidate pairs that do not meet; tight: on "
    "the host, by boxes; device: on the device, by root k-DOPs"};
inline constexpr Setting<std::int64_t> first_body_pair{
    "first_body_pair", 0, ValueRange{0, word_limit}, "",
    "broad=sphere_boxes: the first body pair to walk, in ascending order; with most_body_pairs, to measure a "
    "part of a frame that takes minutes"};
inline constexpr Setting<std::int64_t> most_body_pairs{
    "most_body_pairs", 0, ValueRange{0, word_limit}, "",
    "broad=sphere_boxes: how many body pairs to walk at most; 0: all from first_body_pair on"};
inline constexpr Setting<SelfPairs> self{
    "self",
    SelfPairs::off,
    {{"off", SelfPairs::off}, {"on", SelfPairs::on}, {"deformable", SelfPairs::deformable}},
    "SELF",
    "bodies whose tetrahedra are also paired with each other, unless they share a vertex: on: all that are "
    "not fixed; deformable: deformable ones"};
inline constexpr Setting<std::int64_t> body_pair_capacity{"body_pair_capacity", 65536,
                                                          ValueRange{1, word_limit}, "",
                                                          "broad=device: initial capacity for body pairs"};
inline constexpr Setting<Residency> residency{
    "residency",
    Residency::resident,
    {{"resident", Residency::resident}, {"published", Residency::published}},
    "",
    "published: convert, upload and read back everything in every frame, as the paper's code"};
inline constexpr Setting<Conversion> convert{
    "convert",
    Conversion::serial,
    {{"serial", Conversion::serial}, {"parallel", Conversion::parallel}},
    "",
    "residency=published: threads that convert bodies to the device's arrays and trees, and back: serial: "
    "one, as in the paper's tables; parallel: as many as setting threads allows, as its OpenMP"};
inline constexpr Setting<TreeCopies> copies{
    "copies",
    TreeCopies::none,
    {{"none", TreeCopies::none}, {"pair", TreeCopies::pair}},
    "",
    "residency=published: copies that the host makes of the trees in body pairs before a walk: pair: two of "
    "both for each body pair, as the paper's code, also of trees that it has copied before"};
inline constexpr Setting<Submission> submission{
    "submission",
    Submission::one,
    {{"one", Submission::one}, {"each", Submission::each}},
    "",
    "submission of a resident frame's commands: one: together, as a CUDA graph, if the last frame had the "
    "same, uploads are small and the host finds no body pairs; each: one by one, as on other devices"};
inline constexpr Setting<Output> output{
    "output",
    Output::pairs,
    {{"pairs", Output::pairs},
     {"count", Output::count},
     {"digest", Output::digest},
     {"contacts", Output::contacts},
     {"distances", Output::distances},
     {"wrenches", Output::wrenches}},
    "OUTPUT",
    "output of a walk: pairs: candidate pairs, and contacts; count, digest: only these of the pairs; "
    "contacts: as pairs, without interior tetrahedra if the contact rule makes contacts of boundary faces "
    "only, so that they are the same; distances: as contacts, but of each body pair only the least distance, "
    "with contact_rule=distance; wrenches: as contacts, but of each body pair only force, torque and area, "
    "with contact_rule=pressure"};
inline constexpr Setting<AnswerOrder> order{
    "order",
    AnswerOrder::any,
    {{"any", AnswerOrder::any}, {"canonical", AnswerOrder::canonical}},
    "",
    "order of pairs and contacts on the device: any; canonical: by body a, tetrahedron a, body b, "
    "tetrahedron b "
    "and feature, so that bytes are equal over runs, algorithms and devices"};
inline constexpr Setting<PairLayout> pair_layout{
    "pair_layout",
    PairLayout::slots,
    {{"slots", PairLayout::slots}, {"items", PairLayout::items}},
    "PAIR_LAYOUT",
    "format of a candidate pair on the device: slots: 8 bytes, the slots of two tetrahedra; items: 16 bytes, "
    "as in the published data path and in scenes of more than 2^32 slots"};
inline constexpr Setting<std::int64_t> group_size{
    "group_size", 0, ValueRange{0, 1024}, "GROUP_SIZE",
    "work-items per work-group (1 on host); 0: 128, on processors 1 if algorithm=tiled"};
inline constexpr Setting<std::int64_t> work_items{
    "work_items", 2048, ValueRange{1, 1 << 20}, "",
    "work-items per compute unit of kernels with strided loops"};
inline constexpr Setting<std::int64_t> threads{
    "threads", 0, ValueRange{0, 4096}, "",
    "threads that run the work-groups of device host; 0: one per core; other devices ignore it"};
inline constexpr Setting<std::int64_t> pair_capacity{"pair_capacity", 1048576, ValueRange{1, word_limit}, "",
                                                     "initial capacity for candidate pairs"};
inline constexpr Setting<std::int64_t> contact_capacity{
    "contact_capacity", 1048576, ValueRange{1, word_limit}, "", "initial capacity for contacts"};

} // namespace tandem::parameters

namespace tandem {

/// Whether these settings select the paper's data path.
inline bool is_published(const Settings& settings) {
    return settings.has(parameters::residency) && settings[parameters::residency] == Residency::published;
}

/// Whether a session with these settings makes contacts, in runs that do not count work.
inline bool makes_contacts(const Settings& settings) {
    return has_pairs(settings[parameters::output]) && settings[parameters::contact_rule] != ContactRule::none;
}

/// Whether nodes bound pressures.
inline bool bounds_pressures(const Settings& settings) {
    return settings.has(parameters::pressure_slab) && settings[parameters::pressure_slab];
}

/// Whether these contacts are polygons of equal pressure.
inline bool has_polygons(const Settings& settings) {
    return settings.has(parameters::contact_rule) && makes_contacts(settings)
           && needs_pressures(settings[parameters::contact_rule]);
}

/// Whether a session walks a part of a frame's body pairs (first_body_pair, most_body_pairs).
inline bool walks_part(const Settings& settings) {
    return settings.has(parameters::first_body_pair)
           && (settings[parameters::first_body_pair] != 0 || settings[parameters::most_body_pairs] != 0);
}

} // namespace tandem
