// What this machine can do at most: the bounds that a method's speed is read against.
#pragma once

namespace pivnp::bench {

/// Bytes a second of a[i] = b[i] + s c[i] on floats in memory (three streams of 64 MiB, write-allocate not counted).
double triad_bandwidth(int threads);

/// Floating-point operations a second, single precision: fused multiply-adds in registers, the widest vectors there
/// are.
double multiply_add_peak(int threads);

}  // namespace pivnp::bench
