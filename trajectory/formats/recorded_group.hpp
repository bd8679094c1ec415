#pragma once
/// \file
/// The group /parameters/drive/recorded of a trajectory: the motion of a plate that was recorded.

#include <hdf5.h>

#include <memory>

#include "core/error.hpp"
#include "trajectory/recorded_motion.hpp"

namespace twincell {

/// Creates the group below `drive`:
///
///     samples    f64[n][3]  displacement, velocity, acceleration; sigma, sigma/t0, sigma/t0^2
///     interval   f64        between samples, t0
///     start      f64        time from the first sample to the beginning of cycle 0, t0
///     cycles     f64        whole cycles of a repeated record; 0: it is not repeated
///     @file, @sha256        of the record
void write_recorded(hid_t drive, const RecordedMotion& motion);

/// Reads it.
/// \throws InputError at `where` for missing or more than kMaxSamples samples, and for numbers that no record
/// has
std::shared_ptr<const RecordedMotion> read_recorded(hid_t drive, const Where& where);

}  // namespace twincell
