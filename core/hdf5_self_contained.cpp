#include "core/hdf5_self_contained.hpp"

#include <fmt/format.h>

#include "core/hdf5.hpp"

namespace twincell::h5 {

namespace {

std::string sentence(const char* name, const char* kind) {
  return fmt::format("/{} is {}; only data in the file itself is read, so copy it into one file.", name,
                     kind);
}

}  // namespace

std::string data_elsewhere(hid_t file) {
  std::string found;
  // Both visitors stop at the first hit by returning 1. A file too damaged to be visited is left to its
  // reader.
  const auto link = [](hid_t, const char* name, const H5L_info_t* info, void* to) -> herr_t {
    if (info->type < H5L_TYPE_UD_MIN) return 0;  // hard and soft links stay within the file
    *static_cast<std::string*>(to) = sentence(name, "a link to another file");
    return 1;
  };
  H5Lvisit(file, H5_INDEX_NAME, H5_ITER_NATIVE, link, &found);
  if (!found.empty()) return found;
  const auto object = [](hid_t root, const char* name, const H5O_info_t* info, void* to) -> herr_t {
    if (info->type != H5O_TYPE_DATASET) return 0;
    const Handle dataset(H5Dopen2(root, name, H5P_DEFAULT));
    const Handle layout(dataset ? H5Dget_create_plist(dataset.get()) : -1);
    if (!layout) return 0;
    const bool is_virtual = H5Pget_layout(layout.get()) == H5D_VIRTUAL;
    if (!is_virtual && H5Pget_external_count(layout.get()) <= 0) return 0;
    *static_cast<std::string*>(to) =
        sentence(name, is_virtual ? "a virtual dataset, whose data is in other files"
                                  : "a dataset that is stored in another file");
    return 1;
  };
  H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_NATIVE, object, &found, H5O_INFO_BASIC);
  return found;
}

}  // namespace twincell::h5
