#pragma once
/// \file
/// The groups ramp and horizontal of /parameters/drive of a trajectory.

#include <hdf5.h>

#include "core/error.hpp"
#include "trajectory/drive.hpp"

namespace twincell {

/// Creates the groups that `motion` has:
///
///     ramp/amplitude, ramp/omega  f64  at its end; before it those of the drive
///     ramp/power                  i32  A omega^power is linear in time
///     ramp/first, ramp/cycles     f64  cycle at which it begins, counted from the start of the drive; length
///     ramp/returns                i32  1: half of the cycles lead back
///     horizontal/amplitude        f64  sigma
///     horizontal/ratio            i32  frequency relative to that of the drive
///     horizontal/phase            f64  cycles of this motion
void write_drive_motion(hid_t drive, const Drive& motion);

/// Reads them into `motion`, whose amplitude and omega are known.
/// \throws InputError at `where` for numbers that no drive has
void read_drive_motion(hid_t drive, Drive& motion, const Where& where);

}  // namespace twincell
