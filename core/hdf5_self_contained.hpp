#pragma once
/// \file
/// HDF5 files whose data is in other files.

#include <hdf5.h>

#include <string>

namespace twincell::h5 {

/// The first object of an open file whose data HDF5 would read from another file: an external link, a virtual
/// dataset, or a dataset with external storage. A file from a stranger could otherwise make a reader open any
/// file of the user's account, and HDF5 replaces missing parts of a virtual dataset by zeros without an
/// error. Links inside the file are not followed.
/// \returns a sentence that names the object; empty if there is none
std::string data_elsewhere(hid_t file);

}  // namespace twincell::h5
