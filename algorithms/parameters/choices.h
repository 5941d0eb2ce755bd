// SPDX-License-Identifier: MIT
// What the common settings choose from. Kernels see an enumerator's number under the setting's define; names
// for these numbers stand in choices.clh, and choices.cpp does not compile when the two differ.
#pragma once

namespace tandem {

/// Which directions k = 8 has.
enum class Axes {
    standard,  ///< the paper's four cube diagonals; for other k the symmetric sets of directions.clh
    coordinate ///< x, y, z and one diagonal
};

/// Bits of a real number in vertices, slabs and contacts.
enum class Precision { fp32 = 32, fp64 = 64 };

/// How a slab's ends are rounded; bounds/README.md has what each is good for.
enum class Rounding {
    nearest,   ///< to nearest, nothing added: misses pairs on directions with three non-zeros
    safe,      ///< widened where the rounding is not monotone: misses nothing
    published, ///< the paper's: unit directions, an absolute tolerance of 10 FLT_EPSILON; misses pairs
    directed   ///< outwards, on devices that can: slabs contain the exact ones
};

/// Where the vertices are whose contacts no slab may miss.
enum class Placement {
    rounded, ///< the world vertices in the cell's precision, after their transform has been rounded
    exact    ///< the scene's own doubles where its poses put them, moved without rounding
};

/// What coordinates on devices count from.
enum class Origin {
    world,
    automatic ///< a point in the middle of the scene where it begins, zero when that is near enough
};

/// Who finds body pairs.
enum class Broad {
    sphere, ///< the host, by the paper's spheres
    tight,  ///< the host, by boxes
    device  ///< the device, by root k-DOPs
};

/// Where the data of a frame lives between frames.
enum class Residency {
    resident, ///< topology once, shared by bodies with one mesh; a frame uploads poses or vertices only
    published ///< as the paper's code: everything converted, uploaded and read back in every frame
};

/// Who converts a frame's bodies where the host does in every frame.
enum class Conversion {
    serial,  ///< one thread
    parallel ///< all that setting threads allows
};

/// How a frame's commands get to the device.
enum class Submission {
    one, ///< together, where the device knows how and the frame before had the same commands
    each ///< one by one
};

/// In which order a body's tetrahedra stand, and so which of them share a node.
enum class Builder {
    morton,  ///< along the Z-curve, as the paper
    sah,     ///< cut by the surface area heuristic into runs of 32, 32^2, ...
    breadth, ///< breadth-first from face to face, which the paper tried first
    hilbert, ///< along Hilbert's curve
    median   ///< halved along the longest axis, at such runs
};

/// Directions that the leaves of a hierarchy of tiles have bounds along.
enum class Slabs {
    three, ///< the first three of the geometry's; the others are decided from vertices
    all,
    usual ///< one of the above, by device and k: no kernel sees it
};

/// What a candidate pair is in a device's memory (answer/pairs.clh).
enum class PairLayout {
    items, ///< 16 bytes: body a, body b, and the positions of the two tetrahedra in their bodies' orders
    slots  ///< 8 bytes: two numbers of tetrahedra over all bodies
};

/// What a walk hands out.
enum class Output { pairs, count, digest };

/// How contacts are made of a pair that meets; contacts/README.md has the rules.
enum class ContactRule { opposing, published, sat, clip, restricted, vertex, consistent, growth, none };

/// What decides whether a pair meets.
enum class DecisionPrecision {
    fp32,    ///< separating axes in the cell's precision; what they do not tell apart meets
    recheck, ///< a certified filter in the cell's precision, then double for what it cannot decide
    fp64,    ///< the certified decision in double for all pairs
    exact    ///< as recheck, then exact arithmetic on the host for what double cannot decide
};

} // namespace tandem
