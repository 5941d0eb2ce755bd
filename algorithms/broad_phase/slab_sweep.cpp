// SPDX-License-Identifier: MIT
#include "algorithms/broad_phase/slab_sweep.h"

#include "base/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

namespace tandem {

namespace {

constexpr std::size_t min_bodies_for_cells = 2048; ///< for fewer bodies one sweep is as fast
constexpr double bodies_per_cell = 256;            ///< least average; smaller cells cost more than they save
constexpr double widths_per_strip = 2;        ///< average body widths; most bodies are twice in narrower ones
constexpr std::size_t max_cells_per_body = 4; ///< on average

struct Ends {
    std::span<const double> ends;
    std::size_t axes;

    std::size_t bodies() const { return ends.size() / (2 * axes); }
    double lower(std::size_t body, std::size_t axis) const { return ends[2 * (body * axes + axis)]; }
    double upper(std::size_t body, std::size_t axis) const { return ends[2 * (body * axes + axis) + 1]; }
};

/// Sets apart[j] != 0 for the bodies j = i + 1 .. end - 1 that a direction separates from body i.
void mark_apart(const std::vector<std::vector<double>>& along, std::size_t i, std::size_t end,
                std::vector<std::int64_t>& apart) {
    std::fill(apart.begin() + static_cast<std::ptrdiff_t>(i),
              apart.begin() + static_cast<std::ptrdiff_t>(end), 0);
    for (std::size_t slab = 0; slab < along.size(); slab += 2) {
        const double lower = along[slab][i];
        const double upper = along[slab + 1][i];
        const double* lowers = along[slab].data();
        const double* uppers = along[slab + 1].data();
        for (std::size_t j = i + 1; j < end; ++j)
            apart[j] |=
                static_cast<std::int64_t>(lowers[j] > upper) | static_cast<std::int64_t>(uppers[j] < lower);
    }
}

/// Calls visit(a, b) for the overlapping pairs of `bodies`; a may be the larger.
template<class Visit>
void sweep_along(const Ends& slabs, std::size_t axis, std::vector<std::uint32_t> bodies, const Visit& visit) {
    std::sort(bodies.begin(), bodies.end(),
              [&](auto a, auto b) { return slabs.lower(a, axis) < slabs.lower(b, axis); });
    std::vector<std::vector<double>> along(2 * slabs.axes, std::vector<double>(bodies.size()));
    for (std::size_t slab = 0; slab < along.size(); ++slab)
        for (std::size_t i = 0; i < bodies.size(); ++i)
            along[slab][i] = slabs.ends[bodies[i] * along.size() + slab];
    std::vector<std::int64_t> apart(bodies.size()); // as wide as a double, for vector code
    const auto& starts = along[2 * axis];
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const auto end =
            static_cast<std::size_t>(std::upper_bound(starts.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                                                      starts.end(), along[2 * axis + 1][i])
                                     - starts.begin());
        mark_apart(along, i, end, apart);
        for (std::size_t j = i + 1; j < end; ++j)
            if (apart[j] == 0) visit(bodies[i], bodies[j]);
    }
}

/// Equal parts of the range of bodies along an axis; the first and the last are unbounded.
struct Strips {
    std::size_t axis = 0, count = 1;
    double first = 0, width = 1;

    std::size_t at(double value) const {
        const double position = (value - first) / width;
        if (!(position > 0)) return 0; // also for NaN
        return position < static_cast<double>(count) ? static_cast<std::size_t>(position) : count - 1;
    }
};

/// The same range in `count` strips.
Strips divided(Strips strips, std::size_t count) {
    strips.width *= static_cast<double>(strips.count) / static_cast<double>(count);
    strips.count = count;
    return strips;
}

/// Strips of `widths_per_strip` average body widths.
Strips strips_of(const Ends& slabs, std::size_t axis) {
    double first = std::numeric_limits<double>::infinity(), last = -first, sum = 0;
    for (std::size_t body = 0; body < slabs.bodies(); ++body) {
        const double lower = slabs.lower(body, axis), upper = slabs.upper(body, axis);
        if (!std::isfinite(lower) || !std::isfinite(upper)) continue;
        first = std::min(first, lower);
        last = std::max(last, upper);
        sum += upper - lower;
    }
    const double mean = sum / static_cast<double>(slabs.bodies());
    const double count =
        std::min((last - first) / (widths_per_strip * mean), static_cast<double>(slabs.bodies()));
    if (!(count > 1)) return {.axis = axis};
    return divided({axis, 1, first, last - first}, static_cast<std::size_t>(count));
}

/// Bodies by the cells of two axes that they overlap. A pair belongs to the one cell that contains, along
/// both axes, the larger of its two lower ends.
class BodyCells {
public:
    BodyCells(const Ends& slabs, Strips rows, Strips columns)
        : slabs_(slabs), rows_(rows), columns_(columns) {}

    std::size_t count() const { return rows_.count * columns_.count; }
    /// Bins the bodies. Reduces the number of cells first, until the average body is in few cells.
    void fill() {
        while (reached_cells() > max_cells_per_body * slabs_.bodies() + count()) {
            rows_ = divided(rows_, (rows_.count + 1) / 2);
            columns_ = divided(columns_, (columns_.count + 1) / 2);
        }
        starts_.assign(count() + 1, 0);
        for_cells([&](std::size_t cell, std::uint32_t) { ++starts_[cell + 1]; });
        std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
        bodies_.resize(starts_.back());
        auto next = starts_;
        for_cells([&](std::size_t cell, std::uint32_t body) { bodies_[next[cell]++] = body; });
    }
    std::vector<std::uint32_t> bodies(std::size_t cell) const {
        const auto at = [&](std::size_t i) {
            return bodies_.begin() + static_cast<std::ptrdiff_t>(starts_[i]);
        };
        return {at(cell), at(cell + 1)};
    }
    std::size_t cell_of(std::uint32_t a, std::uint32_t b) const {
        return std::max(row(a), row(b)) * columns_.count + std::max(column(a), column(b));
    }

private:
    std::size_t row(std::uint32_t body) const { return rows_.at(slabs_.lower(body, rows_.axis)); }
    std::size_t column(std::uint32_t body) const { return columns_.at(slabs_.lower(body, columns_.axis)); }
    /// Calls work(cell, body) for all cells of all bodies.
    template<class Work>
    void for_cells(const Work& work) const {
        for (std::uint32_t body = 0; body < slabs_.bodies(); ++body) {
            const auto last_row = rows_.at(slabs_.upper(body, rows_.axis));
            const auto last_column = columns_.at(slabs_.upper(body, columns_.axis));
            for (auto r = row(body); r <= last_row; ++r)
                for (auto c = column(body); c <= last_column; ++c) work(r * columns_.count + c, body);
        }
    }
    std::size_t reached_cells() const {
        std::size_t sum = 0;
        for_cells([&](std::size_t, std::uint32_t) { ++sum; });
        return sum;
    }

    const Ends& slabs_;
    Strips rows_, columns_;
    std::vector<std::size_t> starts_; ///< by cell, in bodies_
    std::vector<std::uint32_t> bodies_;
};

/// The pairs by cell.
std::vector<std::vector<BodyPair>> sweep_cells(const Ends& slabs, Strips rows, Strips columns,
                                               std::size_t axis) {
    BodyCells cells(slabs, rows, columns);
    cells.fill();
    std::vector<std::vector<BodyPair>> found(cells.count());
    parallel_for(cells.count(), [&](std::size_t cell) {
        sweep_along(slabs, axis, cells.bodies(cell), [&](std::uint32_t a, std::uint32_t b) {
            if (cells.cell_of(a, b) == cell) found[cell].push_back({std::min(a, b), std::max(a, b)});
        });
    });
    return found;
}

/// The pairs ordered by a, then b: two passes of a counting sort.
std::vector<BodyPair> ascending(std::vector<BodyPair> pairs, std::size_t bodies) {
    std::vector<BodyPair> other(pairs.size());
    for (const auto key : {&BodyPair::b, &BodyPair::a}) {
        std::vector<std::size_t> next(bodies + 1);
        for (const auto& pair : pairs) ++next[pair.*key + 1];
        std::partial_sum(next.begin(), next.end(), next.begin());
        for (const auto& pair : pairs) other[next[pair.*key]++] = pair;
        pairs.swap(other);
    }
    return pairs;
}

} // namespace

std::vector<BodyPair> overlapping(std::span<const double> ends, std::size_t axes, std::size_t sweep) {
    const Ends slabs{ends, axes};
    const auto bodies = slabs.bodies();
    // Sweeps along the axis with the most strips.
    std::array<Strips, 3> strips;
    for (std::size_t axis = 0; axis < 3; ++axis) strips[axis] = strips_of(slabs, axis);
    std::ranges::sort(strips, std::greater{}, &Strips::count);
    const auto most = static_cast<std::size_t>(std::sqrt(static_cast<double>(bodies) / bodies_per_cell)) + 1;
    for (auto& some : std::span(strips).subspan(1)) some = divided(some, std::min(some.count, most));
    std::vector<BodyPair> pairs;
    if (bodies < min_bodies_for_cells || strips[1].count == 1) {
        std::vector<std::uint32_t> all(bodies);
        std::iota(all.begin(), all.end(), 0u);
        sweep_along(slabs, sweep, std::move(all), [&](std::uint32_t a, std::uint32_t b) {
            pairs.push_back({std::min(a, b), std::max(a, b)});
        });
    } else {
        for (const auto& some : sweep_cells(slabs, strips[1], strips[2], strips[0].axis))
            pairs.insert(pairs.end(), some.begin(), some.end());
    }
    return ascending(std::move(pairs), bodies);
}

} // namespace tandem
