#pragma once
/// \file
/// Contents of an HDF5 file, for comparisons bit for bit.

#include <gtest/gtest.h>
#include <hdf5.h>

#include <map>
#include <string>

#include "core/hdf5.hpp"

namespace twincell {

/// The bytes of every numeric dataset in a file, by path. Provenance, which contains dates, is text.
inline std::map<std::string, std::string> datasets_of(const std::string& path) {
  std::map<std::string, std::string> all;
  const h5::Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  EXPECT_TRUE(file) << path;
  if (!file) return all;
  H5Lvisit(
      file.get(), H5_INDEX_NAME, H5_ITER_INC,
      [](hid_t group, const char* name, const H5L_info_t* /*link*/, void* out) -> herr_t {
        const h5::Handle set(H5Oopen(group, name, H5P_DEFAULT));
        if (H5Iget_type(set.get()) != H5I_DATASET) return 0;
        const h5::Handle type(H5Dget_type(set.get())), space(H5Dget_space(set.get()));
        if (H5Tget_class(type.get()) == H5T_STRING) return 0;
        std::string bytes(
            static_cast<std::size_t>(H5Sget_simple_extent_npoints(space.get())) * H5Tget_size(type.get()), 0);
        H5Dread(set.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data());
        (*static_cast<std::map<std::string, std::string>*>(out))[name] = bytes;
        return 0;
      },
      &all);
  return all;
}

}  // namespace twincell
