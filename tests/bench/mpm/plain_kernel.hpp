// The yardstick of mpm_throughput: a plain MLS-MPM step as a reader of the papers would write it (Hu et al. 2018, ACM Trans.
// Graph. 37:150; quadratic B-splines, APIC), in double precision, compiled for this processor alone. A linear elastic block
// under gravity on a fixed floor; no guards, no energies, no averages, no order of the points but the one they start in.
#pragma once

namespace pivnp::bench {

/// Million particle-steps a second, by the processor time of one thread: a block of cells x cells, 2 x 2 points each, in a
/// box of 2 x 1.2 of it.
double plain_rate(int cells, double steps);

}  // namespace pivnp::bench
