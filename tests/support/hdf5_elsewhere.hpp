#pragma once
/// \file
/// HDF5 objects whose data are in another file.

#include <array>
#include <string>

#include "core/hdf5.hpp"

namespace twincell::test {

/// Adds an object of the given `kind` to an open file: "link", "virtual" or "external". Its data are in
/// `other`.
inline void add_elsewhere(hid_t file, const std::string& kind, const std::string& other) {
  const std::array<hsize_t, 3> shape = {2, 3, 4};
  if (kind == "link")
    return h5::check(H5Lcreate_external(other.c_str(), "/frames", file, "linked", H5P_DEFAULT, H5P_DEFAULT),
                     kind);
  const h5::Handle space = h5::own(H5Screate_simple(3, shape.data(), nullptr), "space");
  const h5::Handle create = h5::own(H5Pcreate(H5P_DATASET_CREATE), "plist");
  if (kind == "virtual")
    h5::check(H5Pset_virtual(create.get(), space.get(), other.c_str(), "/frames", space.get()), kind);
  else
    h5::check(H5Pset_external(create.get(), other.c_str(), 0, 24), kind);
  (void)h5::own(
      H5Dcreate2(file, kind.c_str(), H5T_STD_U8LE, space.get(), H5P_DEFAULT, create.get(), H5P_DEFAULT),
      kind);
}

}  // namespace twincell::test
