#pragma once
/// \file
/// Opening of HDF5 files for reading, which the HDF5 library may be unable to survive.

#include <filesystem>

#include "core/hdf5.hpp"

namespace twincell::h5 {

/// Opens a file for reading. The result converts to false if it cannot be opened, is not HDF5 or is not a
/// regular file: opening a pipe without a writer would never return.
///
/// A child process reads the file first (hdf5_trial.hpp), since the HDF5 library crashes on some damaged
/// files. It may use 3 s of processor time, and 1 s more for each 50 MB of the file; in memory, 1 GiB more
/// than this process and four times the file. A file that it has read is not tried again in this process as
/// long as its inode, size and times remain. Where no child can be made, the file is read without a trial.
///
/// \throws InputError if the child crashes, exceeds a limit or runs out of memory
/// \throws Interrupted if cancellation is requested during the trial
Handle open_file(const std::filesystem::path& file);

}  // namespace twincell::h5
