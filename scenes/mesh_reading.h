// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string_view>

namespace tandem {

/// Handling of duplicates: tetrahedra with the same four vertices as an earlier one, in any order.
enum class Duplicates {
    merge, ///< keep their numbers, but take no part in answers, bounds and boundary faces
    keep,  ///< take part as every other tetrahedron
    reject ///< are an error
};

/// The values of Duplicates as options and records name them, in this order.
inline constexpr std::array<std::string_view, 3> duplicates_names{"merge", "keep", "reject"};

/// How meshes are read and connected. Decided once, before the first frame, in the unit of the scene: after
/// the scale of a description.
struct MeshReading {
    Duplicates duplicates = Duplicates::merge;
    /// Vertices at most this far apart, also along chains, are one vertex for boundary faces, duplicates and
    /// setting self. Coordinates stay. None: only equal vertex numbers are one vertex.
    std::optional<double> weld{};
    bool corners = false;         ///< tetrahedra of higher order become those of their corners, not an error
    bool only_tetrahedra = false; ///< other volume cells are left out, not an error
    /// The modulus of the pressure field that meshes without one get (make_pressures). None: they stay
    /// without.
    std::optional<double> pressure{};

    bool operator==(const MeshReading&) const = default;
};

/// The value of Duplicates with this name. Throws InputError that begins with `option`.
Duplicates duplicates_named(std::string_view name, std::string_view option = "duplicates");

/// Returns a tolerance for MeshReading::weld. Throws InputError that begins with `option` when it is negative
/// or not finite.
double checked_weld(double tolerance, std::string_view option = "weld");

/// The largest pressure and modulus: they are numbers of single precision on devices.
inline constexpr double most_pressure = std::numeric_limits<float>::max();

/// Returns a modulus for MeshReading::pressure. Throws InputError that begins with `option` unless it is
/// above 0 and at most most_pressure.
double checked_pressure(double modulus, std::string_view option = "pressure");

} // namespace tandem
