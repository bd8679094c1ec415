#include "trajectory/formats/contact_lists.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/error.hpp"

namespace twincell {

ContactListWriter::ContactListWriter(h5::Handle group, hid_t value_type, std::size_t each)
    : group_(std::move(group)), value_type_(value_type), each_(each) {
  count_ = h5::Series(group_.get(), "count", H5T_STD_I64LE, {});
  pairs_ = h5::Series(group_.get(), "pairs", H5T_STD_I32LE, {2});
  if (each_ > 0) values_ = h5::Series(group_.get(), "values", value_type_, {each_});
}

void ContactListWriter::append(const std::vector<std::int32_t>& pairs, const std::vector<double>& values) {
  const auto n = static_cast<std::int64_t>(pairs.size() / 2);
  count_.append(h5::native<std::int64_t>(), &n);
  if (n == 0) return;
  if (!values_) {
    each_ = values.size() / (pairs.size() / 2);
    values_ = h5::Series(group_.get(), "values", value_type_, {each_});
  }
  if (values.size() != each_ * static_cast<std::size_t>(n))
    throw RunError("the contacts of one frame have different numbers of values.");
  pairs_.append(h5::native<std::int32_t>(), pairs.data(), static_cast<hsize_t>(n));
  values_.append(h5::native<double>(), values.data(), static_cast<hsize_t>(n));
}

void ContactListReader::refuse(const std::string& key, const std::string& complaint) const {
  throw InputError({file_name_, 0, 0, where_ + key}, complaint);
}

ContactListReader::ContactListReader(hid_t file, std::string where, std::string file_name, std::size_t frames,
                                     std::size_t beads)
    : where_(std::move(where)), file_name_(std::move(file_name)), beads_(static_cast<std::int64_t>(beads)) {
  if (!h5::exists(file, where_)) return;
  count_ = h5::read_dataset<std::int64_t>(file, where_ + "/count");
  if (count_.size() != frames) refuse("/count", "one number per frame is needed.");
  pairs_ = h5::Series(file, where_ + "/pairs");
  values_ = h5::Series(file, where_ + "/values");
  if (!pairs_ || pairs_.record() != std::vector<hsize_t>{2})
    refuse("/pairs", "two numbers per contact are needed.");
  std::int64_t sum = 0;
  const auto all = static_cast<std::int64_t>(pairs_.size());
  for (const std::int64_t n : count_) {
    if (n < 0 || n > all - sum)
      refuse("/count",
             fmt::format("a count of {} contacts exceeds the {} contacts that are stored.", n, all));
    begin_.push_back(sum);
    sum += n;
  }
  if (all > 0 && (!values_ || values_.record().size() != 1 || values_.size() != pairs_.size()))
    refuse("/values", "every contact must have the same number of values.");
  each_ = all > 0 ? static_cast<std::size_t>(values_.record()[0]) : 0;
}

void ContactListReader::read(std::size_t frame, std::vector<std::int32_t>& pairs,
                             std::vector<double>& values) const {
  const auto n = static_cast<std::size_t>(count_[frame]);
  const auto begin = static_cast<hsize_t>(begin_[frame]);
  pairs.resize(2 * n);
  values.resize(each_ * n);
  if (n == 0) return;
  pairs_.read(begin, h5::native<std::int32_t>(), pairs.data(), n);
  if (each_ > 0) values_.read(begin, h5::native<double>(), values.data(), n);
  constexpr std::int32_t kMaxWalls = 100;
  for (std::size_t k = 0; k < n; ++k) {
    const std::int32_t i = pairs[2 * k], j = pairs[2 * k + 1];
    if (i < 0 || i >= beads_ || j >= beads_ || j < -kMaxWalls || (j >= 0 && j <= i))
      refuse("/pairs", fmt::format("({}, {}) is not a contact of {} beads.", i, j, beads_));
    for (std::size_t m = 0; m < each_; ++m)
      if (!std::isfinite(values[k * each_ + m]))
        refuse("/values", fmt::format("a value of contact ({}, {}) is not finite.", i, j));
  }
}

ConnectivityWriter::ConnectivityWriter(hid_t file, const std::string& particles) {
  const h5::Handle connectivity = h5::create_group(file, "connectivity");
  const h5::Handle group = h5::create_group(connectivity.get(), "contacts");
  const h5::Handle beads = h5::own(H5Oopen(file, particles.c_str(), H5P_DEFAULT), "opening " + particles);
  for (const std::string shared : {"step", "time"})
    h5::check(H5Lcreate_hard(beads.get(), ("position/" + shared).c_str(), group.get(), shared.c_str(),
                             H5P_DEFAULT, H5P_DEFAULT),
              "linking contacts");
  hobj_ref_t reference = 0;
  h5::check(H5Rcreate(&reference, file, particles.c_str(), H5R_OBJECT, -1), "referring to " + particles);
  const h5::Handle scalar = h5::own(H5Screate(H5S_SCALAR), "making a space");
  const h5::Handle attribute = h5::own(
      H5Acreate2(group.get(), "particles_group", H5T_STD_REF_OBJ, scalar.get(), H5P_DEFAULT, H5P_DEFAULT),
      "making an attribute");
  h5::check(H5Awrite(attribute.get(), H5T_STD_REF_OBJ, &reference), "writing an attribute");

  constexpr hsize_t kPerChunk = 1024;
  const hsize_t now[] = {0, 0, 2}, most[] = {H5S_UNLIMITED, H5S_UNLIMITED, 2}, chunk[] = {1, kPerChunk, 2};
  const h5::Handle space = h5::own(H5Screate_simple(3, now, most), "making a space");
  const h5::Handle plist = h5::own(H5Pcreate(H5P_DATASET_CREATE), "making a property list");
  h5::check(H5Pset_chunk(plist.get(), 3, chunk), "setting chunks");
  h5::check(H5Pset_shuffle(plist.get()), "setting shuffle");
  h5::check(H5Pset_deflate(plist.get(), 4), "setting deflate");
  const std::int32_t unused = -1;
  h5::check(H5Pset_fill_value(plist.get(), h5::native<std::int32_t>(), &unused), "setting the fill value");
  value_ = h5::own(
      H5Dcreate2(group.get(), "value", H5T_STD_I32LE, space.get(), H5P_DEFAULT, plist.get(), H5P_DEFAULT),
      "making value");
}

void ConnectivityWriter::append(const std::vector<std::int32_t>& pairs) {
  std::vector<std::int32_t> beads;
  for (std::size_t k = 0; k + 1 < pairs.size(); k += 2)
    if (pairs[k + 1] >= 0) beads.insert(beads.end(), {pairs[k], pairs[k + 1]});
  const hsize_t n = beads.size() / 2;
  most_ = std::max(most_, n);
  const hsize_t extent[] = {frames_ + 1, most_, 2};
  h5::check(H5Dset_extent(value_.get(), extent), "growing a dataset");
  const hsize_t start[] = {frames_++, 0, 0}, count[] = {1, n, 2};
  if (n == 0) return;
  const h5::Handle file_space = h5::own(H5Dget_space(value_.get()), "reading a space");
  h5::check(H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, start, nullptr, count, nullptr),
            "selecting a record");
  const h5::Handle memory_space = h5::own(H5Screate_simple(3, count, nullptr), "making a space");
  h5::check(H5Dwrite(value_.get(), h5::native<std::int32_t>(), memory_space.get(), file_space.get(),
                     H5P_DEFAULT, beads.data()),
            "writing contacts");
}

}  // namespace twincell
