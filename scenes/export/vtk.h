// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/contact.h"
#include "scenes/scene.h"

namespace tandem {

/// A named number for every tetrahedron of a scene: those of body 0 in input order, then of body 1, and so
/// on.
struct CellNumbers {
    std::string name;
    std::vector<std::uint32_t> values;
};

/// Writes all bodies of a frame as a .vtu file of tetrahedra in world coordinates, rounded to float. Cell
/// data are the numbers of body and tetrahedron and the arrays of `numbers`. Point data are the pressures, in
/// double, if the mesh of every body has a field. Throws InputError.
void write_vtu(const std::string& path, const Scene& scene, const Frame& frame,
               std::span<const CellNumbers> numbers = {});

/// Writes contacts as a .vtp file of points with normal (out of body a), depth (negative inside), and the
/// numbers of bodies, tetrahedra and feature. Throws InputError.
void write_contacts_vtp(const std::string& path, std::span<const ContactPoint> contacts);

/// A file of a series with its time, in s or in frames.
struct TimedFile {
    double time = 0;
    std::string file; ///< relative to the collection
};

/// Writes a .pvd file, which ParaView opens as one series. Throws InputError.
void write_pvd(const std::string& path, std::span<const TimedFile> files);

} // namespace tandem
