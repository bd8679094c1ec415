#include "core/hdf5_trial.hpp"

#include <algorithm>
#include <array>
#include <deque>
#include <set>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "core/hdf5.hpp"
#include "core/hdf5_self_contained.hpp"

namespace twincell::h5 {

namespace {

constexpr std::size_t kMaxNumbers = std::size_t{1} << 24;  ///< of one record, else only its first is read

/// A hard link of a group.
struct Link {
  std::string name;
  haddr_t address;
};

void try_attributes(hid_t object) {
  std::vector<std::string> names;
  const auto visit = [](hid_t, const char* name, const H5A_info_t*, void* to) -> herr_t {
    static_cast<std::vector<std::string>*>(to)->emplace_back(name);
    return 0;
  };
  H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, visit, &names);
  for (const std::string& name : names) try {
      (void)read_text_attribute(object, name);
      (void)read_int_attribute(object, name);
    } catch (const RunError&) {
      continue;
    }
}

/// Reads record `index` of a dataset, or its first number if it has more than kMaxNumbers. Both conversions
/// are tried, since a damaged type may break either.
void try_record(hid_t dataset, const std::vector<hsize_t>& shape, hsize_t index) {
  std::vector<hsize_t> start(shape.size(), 0), count(shape);
  start.front() = index;
  count.front() = 1;
  double numbers = 1;
  for (const hsize_t n : count) numbers *= static_cast<double>(n);
  if (numbers > static_cast<double>(kMaxNumbers)) std::fill(count.begin(), count.end(), 1), numbers = 1;
  const Handle in_file(H5Dget_space(dataset));
  const Handle in_memory(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr));
  if (H5Sselect_hyperslab(in_file.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) < 0)
    return;
  std::vector<double> values(static_cast<std::size_t>(numbers));
  static_assert(sizeof(double) == sizeof(std::int64_t));
  for (const hid_t memory : {native<double>(), native<std::int64_t>()})
    H5Dread(dataset, memory, in_memory.get(), in_file.get(), H5P_DEFAULT, values.data());
}

constexpr std::size_t kCache = std::size_t{64} << 20;  ///< bytes of chunks that are kept unpacked

/// Bytes of an unpacked chunk; 0 if the dataset has no chunks.
double bytes_of_chunk(hid_t layout, hid_t type) {
  std::array<hsize_t, H5S_MAX_RANK> extents{};
  if (H5Pget_layout(layout) != H5D_CHUNKED) return 0;
  const int rank = H5Pget_chunk(layout, H5S_MAX_RANK, extents.data());
  double bytes = static_cast<double>(H5Tget_size(type));
  for (int k = 0; k < rank; ++k) bytes *= static_cast<double>(extents[static_cast<std::size_t>(k)]);
  return bytes;
}

void try_dataset(hid_t parent, const std::string& name) {
  // A chunk is unpacked once for all records and conversions.
  const Handle access(H5Pcreate(H5P_DATASET_ACCESS));
  H5Pset_chunk_cache(access.get(), H5D_CHUNK_CACHE_NSLOTS_DEFAULT, kCache, 1.0);
  const Handle dataset(H5Dopen2(parent, name.c_str(), access.get()));
  const Handle layout(dataset ? H5Dget_create_plist(dataset.get()) : -1);
  const Handle type(dataset ? H5Dget_type(dataset.get()) : -1);
  // The data of the others is in other files.
  if (!layout || !type || H5Pget_layout(layout.get()) == H5D_VIRTUAL ||
      H5Pget_external_count(layout.get()) > 0)
    return;
  require_stored(dataset.get(), name);  // finds all chunks
  std::string text;
  if (read_text(parent, name, text)) return;
  const H5T_class_t kind = H5Tget_class(type.get());
  const std::vector<hsize_t> shape = extents(dataset.get());
  if (kind != H5T_INTEGER && kind != H5T_FLOAT) return;
  // A few bytes can claim a chunk of gigabytes. Its unpacking is the reader's, which refuses what it cannot
  // hold; here it would take the time that a file without an end is known by.
  if (bytes_of_chunk(layout.get(), type.get()) > static_cast<double>(kCache)) return;
  double value = 0;
  if (shape.empty() && read_scalar(parent, name, value)) return;
  if (std::any_of(shape.begin(), shape.end(), [](hsize_t n) { return n == 0; }) || shape.empty()) return;
  try_record(dataset.get(), shape, 0);
  try_record(dataset.get(), shape, shape.front() - 1);
}

std::vector<Link> links_of(hid_t group) {
  std::vector<Link> links;
  const auto visit = [](hid_t, const char* name, const H5L_info_t* info, void* to) -> herr_t {
    if (info->type == H5L_TYPE_HARD) static_cast<std::vector<Link>*>(to)->push_back({name, info->u.address});
    return 0;
  };
  H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, visit, &links);
  return links;
}

}  // namespace

void try_to_read(hid_t file) {
  (void)data_elsewhere(file);
  std::deque<Handle> groups;
  groups.emplace_back(H5Gopen2(file, "/", H5P_DEFAULT));
  std::set<haddr_t> seen;
  for (; !groups.empty(); groups.pop_front()) {
    const hid_t group = groups.front().get();
    try_attributes(group);
    // By its name, as readers do: the search for a name takes other paths through a file than the list of
    // all.
    for (const Link& link : links_of(group)) {
      const bool known = !seen.insert(link.address).second;
      Handle object(H5Oopen(group, link.name.c_str(), H5P_DEFAULT));
      if (!object || known) continue;
      H5O_info_t info{};
      H5Oget_info2(object.get(), &info, H5O_INFO_BASIC);
      if (H5Iget_type(object.get()) == H5I_GROUP) {
        groups.push_back(std::move(object));
      } else if (H5Iget_type(object.get()) == H5I_DATASET) {
        try_attributes(object.get());
        try {
          try_dataset(group, link.name);
        } catch (const RunError&) {
          continue;
        }
      }
    }
  }
}

}  // namespace twincell::h5
