// SPDX-License-Identifier: MIT
// Enumerations of the common settings. A kernel gets the number of an enumerator in the define of the
// setting. choices.clh names these numbers for kernels; choices.cpp does not compile when the two files
// differ. Contact rules have one list for both, contact_rules.clh.
#pragma once

#include "algorithms/parameters/contact_rules.clh"

#include <cstddef>

namespace tandem {

/// Directions for k = 8.
enum class Axes {
    standard,  ///< the paper's four cube diagonals; the sets of directions.clh for other k
    coordinate ///< x, y, z and one diagonal
};

/// Bits of a real number in vertices, slabs and contacts.
enum class Precision { fp32 = 32, fp64 = 64 };

/// Rounding of the ends of slabs; bounds/README.md has the guarantees.
enum class Rounding {
    nearest,   ///< to nearest, without widening: misses pairs on directions with three non-zeros
    safe,      ///< widened if the rounding is not monotone: misses no pair
    published, ///< the paper's: unit directions, an absolute tolerance of 10 FLT_EPSILON; misses pairs
    directed   ///< outwards, on devices with directed rounding: slabs contain the exact ones
};

/// The vertices whose contacts no slab may miss.
enum class Placement {
    rounded, ///< the world vertices in the cell's precision, after rounding of their transform
    exact    ///< the scene's vertices in double, transformed by its poses without rounding
};

/// Positions that the bounds of a frame contain.
enum class Motion {
    none,  ///< those of the frame
    linear ///< those between the frame and its successor
};

/// Origin of coordinates on devices.
enum class Origin {
    world,
    automatic ///< the middle of the scene in its first frame; zero if that is near enough (bodies/origin.h)
};

/// Method that finds body pairs.
enum class Broad {
    sphere,       ///< on the host, by spheres, along the directions of the k-DOPs
    sphere_boxes, ///< on the host, by the boxes of spheres along the coordinate axes, as the paper's release
    tight,        ///< on the host, by boxes
    device        ///< on the device, by root k-DOPs
};

/// Bodies whose tetrahedra are also paired with each other, if they share no vertex.
enum class SelfPairs {
    off,
    on,        ///< all bodies that are not fixed
    deformable ///< deformable bodies
};

/// Location of data between frames.
enum class Residency {
    resident, ///< topology is uploaded once and shared by bodies with one mesh; frames upload only motion
    published ///< as the paper's code: everything is converted, uploaded and read back in every frame
};

/// Threads that convert bodies on the host in every frame.
enum class Conversion {
    serial,  ///< one thread
    parallel ///< as many threads as setting threads allows
};

/// Copies that the host makes of the trees in body pairs before a walk.
enum class TreeCopies {
    none, ///< none
    pair  ///< two of both trees for each body pair, as the paper's code
};

/// Submission of a frame's commands to the device.
enum class Submission {
    one, ///< together, if the device supports it and the last frame had the same commands
    each ///< one by one
};

/// Order of a body's tetrahedra, which decides the nodes that contain them.
enum class Builder {
    morton,  ///< along the Z-curve, as the paper
    sah,     ///< cut by the surface area heuristic into runs of 32, 32^2, ...
    breadth, ///< breadth-first from face to face, which the paper tried first
    hilbert, ///< along Hilbert's curve
    median,  ///< halved along the longest axis, at runs of the same lengths
    balanced ///< cut where a complete binary tree over the body cuts, by the surface area heuristic
};

/// Directions with bounds in the leaves of a hierarchy of tiles.
enum class Slabs {
    three, ///< the first three of the geometry; tests along the rest use vertices
    all,
    touched, ///< all, made only for the tiles that a frame's walk touches if the last one touched few
    usual    ///< one of the above, chosen by device and k before kernels are compiled
};

/// Order of pairs and contacts in a device's memory. Downloads are sorted.
enum class AnswerOrder {
    any,
    canonical ///< by the numbers of bodies and tetrahedra, and of features
};

/// Format of a candidate pair in a device's memory (answer/pairs.clh).
enum class PairLayout {
    items, ///< 16 bytes: body a, body b, and the positions of the two tetrahedra in their bodies' orders
    slots  ///< 8 bytes: the slots of the two tetrahedra, which number those of all bodies
};

/// Output of a walk.
enum class Output {
    pairs, ///< candidate pairs and their contacts
    count,
    digest,
    contacts,  ///< as pairs, without the tetrahedra that cannot make contacts (walked_of)
    distances, ///< as contacts, of which each body pair keeps the one with the least distance
    wrenches   ///< as contacts, the polygons of each body pair added up to force, torque and area
};

/// Whether an answer has pairs, and contacts with a contact rule.
constexpr bool has_pairs(Output output) { return output != Output::count && output != Output::digest; }

/// Whether an answer may lack candidate pairs that make no contacts.
constexpr bool leaves_out_pairs(Output output) {
    return output == Output::contacts || output == Output::distances || output == Output::wrenches;
}

/// Rule that makes contacts of a colliding pair: one of contact_rules.clh, or none.
enum class ContactRule {
#define TANDEM_ENUMERATOR(word, traits, help) word,
    TANDEM_CONTACT_RULES(TANDEM_ENUMERATOR)
#undef TANDEM_ENUMERATOR
        none
};

/// Method that decides whether a pair collides.
enum class DecisionPrecision {
    fp32,    ///< separating axes in the cell's precision; without one the pair collides
    recheck, ///< a certified filter in the cell's precision, then double for undecided pairs
    fp64,    ///< the certified decision in double for all pairs
    exact,   ///< as recheck, then exact arithmetic on the host for undecided pairs
    none,    ///< no pair is rejected, as in the contact kernel of the paper's code
    usual    ///< recheck, exact or fp32, chosen by motion and device before kernels are compiled
};

/// The traits of a rule, a sum of those of contact_rules.clh; 0 for none.
constexpr unsigned traits_of(ContactRule rule) {
    constexpr unsigned traits[] = {
#define TANDEM_TRAITS(word, traits, help) traits,
        TANDEM_CONTACT_RULES(TANDEM_TRAITS)
#undef TANDEM_TRAITS
            0};
    return traits[static_cast<unsigned>(rule)];
}

/// Number of the two tetrahedra of a pair that must have boundary faces for the rule to make contacts.
constexpr unsigned boundaries_needed(ContactRule rule) {
    const unsigned traits = traits_of(rule);
    return (traits & TANDEM_BOTH_BOUNDARY) != 0 ? 2 : (traits & TANDEM_ONE_BOUNDARY) != 0 ? 1 : 0;
}

/// Whether the rule makes one row for each pair within the margin, whether it meets or not.
constexpr bool has_near_pairs(ContactRule rule) { return (traits_of(rule) & TANDEM_WITHIN_MARGIN) != 0; }

/// Whether the rule makes polygons of equal pressure, for which meshes need a pressure field.
constexpr bool needs_pressures(ContactRule rule) { return (traits_of(rule) & TANDEM_PRESSURES) != 0; }

/// PAIR_WORDS of pairs.clh.
constexpr std::size_t words_of(PairLayout layout) { return layout == PairLayout::slots ? 2 : 4; }

} // namespace tandem
