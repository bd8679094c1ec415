#pragma once
/// \file
/// A trial of the HDF5 library on a file: everything that the readers of this program let the library do.

#include <hdf5.h>

namespace twincell::h5 {

/// Visits all groups, datasets and attributes of an open file and reads what a reader would: all names and
/// attributes, the place of every chunk, texts, and the first and the last record of every dataset of
/// numbers whose chunks are not larger than 64 MiB. The result is that it returns: on some damaged files the
/// library reads out of bounds, asks for memory out of all proportion, or never returns. Errors that the
/// library reports are left to the reader.
///
/// \throws std::bad_alloc if memory does not suffice
void try_to_read(hid_t file);

}  // namespace twincell::h5
