// SPDX-License-Identifier: MIT
#include "geometry/program.h"

namespace tandem::geometry {

namespace {

constexpr unsigned rows = 5;    // three coordinates, two sums of weights
constexpr unsigned weights = 8; // four of A, four of B; the column after them is the right-hand side

struct Tableau {
    std::array<std::array<mpq_class, weights + 1>, rows> at;
    std::array<unsigned, rows> basis; ///< a weight, or weights + row for that row's artificial variable

    bool artificial(unsigned row) const { return basis[row] >= weights; }

    /// The sum of the entries of the artificial rows: the rate at which their total falls as this weight
    /// grows.
    mpq_class gain(unsigned column) const {
        mpq_class sum;
        for (unsigned row = 0; row < rows; ++row)
            if (artificial(row)) sum += at[row][column];
        return sum;
    }

    /// The row that first reaches zero as this weight grows; the lowest variable on ties.
    unsigned leaving(unsigned column) const {
        unsigned best = rows;
        mpq_class least;
        for (unsigned row = 0; row < rows; ++row) {
            if (at[row][column] <= 0) continue;
            const mpq_class ratio = at[row][weights] / at[row][column];
            if (best == rows || ratio < least || (ratio == least && basis[row] < basis[best])) {
                best = row;
                least = ratio;
            }
        }
        return best;
    }

    void pivot(unsigned row, unsigned column) {
        const mpq_class by = at[row][column];
        for (auto& x : at[row]) x /= by;
        for (unsigned other = 0; other < rows; ++other) {
            const mpq_class factor = at[other][column];
            if (other == row || factor == 0) continue;
            for (unsigned i = 0; i <= weights; ++i) at[other][i] -= factor * at[row][i];
        }
        basis[row] = column;
    }
};

} // namespace

bool hulls_meet(const Points<mpz_class>& a, const Points<mpz_class>& b) {
    Tableau tableau;
    for (unsigned i = 0; i < 4; ++i) {
        for (unsigned axis = 0; axis < 3; ++axis) {
            tableau.at[axis][i] = a[i][axis];
            tableau.at[axis][4 + i] = -b[i][axis];
        }
        tableau.at[3][i] = tableau.at[4][4 + i] = 1;
    }
    tableau.at[3][weights] = tableau.at[4][weights] = 1;
    for (unsigned row = 0; row < rows; ++row) tableau.basis[row] = weights + row;
    for (unsigned column = 0; column < weights;) {
        if (tableau.gain(column) <= 0) {
            ++column;
            continue;
        }
        tableau.pivot(tableau.leaving(column), column);
        column = 0;
    }
    return tableau.gain(weights) == 0;
}

} // namespace tandem::geometry
