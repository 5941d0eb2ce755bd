// SPDX-License-Identifier: MIT
#include "harness/simulate/simulate.h"
#include "base/standard_streams.h"

namespace tandem {

void warn_not_converged(const StepReport& report) {
    print_message(
        "tandem: step {}: the contact solver has not converged after {} iterations: residual {:.3g} N s "
        "above {:.3g}, energy changed by {:+.3g} J; raise iterations, shorten step or raise "
        "absolute_tolerance (--dynamics NAME=VALUE)\n",
        report.step, report.iterations, report.residual, report.tolerance, report.energy_change);
}

void warn_not_converged(const RunTotals& totals) {
    if (totals.not_converged < 2) return;
    print_message(
        "tandem: the contact solver has not converged in {} of {} steps; the worst is step {}: residual "
        "{:.3g} N s, energy changed by {:+.3g} J\n",
        totals.not_converged, totals.steps, totals.worst.step, totals.worst.residual,
        totals.worst.energy_change);
}

} // namespace tandem
