#include "trajectory/formats/foreign_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "trajectory/wrapped_positions.hpp"

namespace twincell {

ForeignRows::ForeignRows(hid_t group, const h5::Series& id, const h5::Series& position, const Box& box,
                         std::size_t n_beads, const std::string& file)
    : box_(box) {
  if (id) find_slots(id, n_beads, file);
  const bool periodic = box.periodic(Axis::x) || box.periodic(Axis::y) || box.periodic(Axis::z);
  if (!periodic) return;
  images_ = h5::Series(group, "image/value");
  if (images_ && (images_.size() != position.size() || images_.record() != position.record()))
    throw InputError({file, 0, 0, "particles/image"}, "its shape does not match that of position.");
  if (!images_) find_crossings(id, position, n_beads);
}

void ForeignRows::find_slots(const h5::Series& id, std::size_t n_beads, const std::string& file) {
  std::vector<std::int64_t> ids(n_beads), first;
  std::vector<std::size_t> free;  // rows of the first frame without a bead
  bool changes = false;
  for (std::size_t f = 0; f < id.size(); ++f) {
    id.read(f, h5::native<std::int64_t>(), ids.data());
    if (f == 0) {
      first = ids;
      for (std::size_t i = n_beads; i-- > 0;)
        if (ids[i] < 0) free.push_back(i);
    }
    changes = changes || ids != first;
    for (std::size_t i = 0; i < n_beads; ++i) {
      if (ids[i] < 0 || slot_of_.contains(ids[i])) continue;
      if (f > 0 && free.empty())
        throw InputError(
            {file, 0, 0, "particles/id"},
            fmt::format("frame {} has the bead {}, and all {} rows belong to beads of earlier frames.", f,
                        ids[i], n_beads));
      slot_of_[ids[i]] = f == 0 ? i : free.back();
      if (f > 0) free.pop_back();
    }
    std::vector<std::int64_t> sorted = ids;
    std::ranges::sort(sorted);
    const auto twice = std::ranges::adjacent_find(sorted, [](auto a, auto b) { return a == b && a >= 0; });
    if (twice != sorted.end())
      throw InputError({file, 0, 0, "particles/id"},
                       fmt::format("frame {} has the bead {} twice.", f, *twice));
  }
}

void ForeignRows::order(Frame& frame) const {
  if (slot_of_.empty()) return;
  std::vector<std::size_t> row(frame.id.size(), frame.id.size());  // of each slot; its size: none
  for (std::size_t i = 0; i < frame.id.size(); ++i)
    if (frame.id[i] >= 0) row[slot_of_.at(frame.id[i])] = i;
  const Vec3 nowhere = Vec3::Constant(std::nan(""));
  for (std::vector<Vec3>* column : {&frame.position, &frame.position_sigma, &frame.velocity, &frame.spin}) {
    const std::vector<Vec3> before = *column;
    if (before.empty()) continue;
    for (std::size_t slot = 0; slot < row.size(); ++slot)
      (*column)[slot] = row[slot] < row.size() ? before[row[slot]] : nowhere;
  }
  for (std::size_t slot = 0; slot < row.size(); ++slot)
    frame.id[slot] = row[slot] < row.size() ? static_cast<std::int64_t>(slot) : -1;
}

void ForeignRows::find_crossings(const h5::Series& id, const h5::Series& position, std::size_t n_beads) {
  Vec3 period = box_.size();
  for (int k = 0; k < 3; ++k)
    if (!box_.periodic(static_cast<Axis>(k))) period[k] = 0;
  PositionExtent extent;
  PeriodCounter counter(period, n_beads);
  std::vector<Vec3> counts(n_beads, Vec3::Zero());
  Frame frame;
  for (std::size_t f = 0; f < position.size(); ++f) {
    frame.position.resize(n_beads);
    position.read(f, h5::native<double>(), frame.position.data());
    frame.id.resize(id ? n_beads : 0);
    if (id) id.read(f, h5::native<std::int64_t>(), frame.id.data());
    order(frame);
    for (std::size_t i = 0; i < n_beads; ++i) {
      if (!frame.present(i) || !frame.position[i].allFinite()) continue;
      extent.add(frame.position[i]);
      const Vec3& now = counter.next(i, frame.position[i]);
      for (int k = 0; k < 3; ++k)
        if (now[k] != counts[i][k]) crossings_.push_back({f, i, k, now[k]});
      counts[i] = now;
    }
  }
  std::erase_if(crossings_, [&](const Crossing& c) { return !extent.is_wrapped(c.axis, period[c.axis]); });
}

void ForeignRows::restore(std::size_t index, Frame& frame) const {
  if (images_) {
    std::vector<Vec3> images(frame.position.size());
    images_.read(index, h5::native<double>(), images.data());
    for (std::size_t i = 0; i < images.size(); ++i)
      for (int k = 0; k < 3; ++k)
        if (box_.periodic(static_cast<Axis>(k))) frame.position[i][k] += images[i][k] * box_.size()[k];
  }
  order(frame);
  if (crossings_.empty()) return;
  std::vector<Vec3> counts(frame.position.size(), Vec3::Zero());
  for (const Crossing& c : crossings_) {
    if (c.frame > index) break;
    counts[c.bead][c.axis] = c.periods;
  }
  for (std::size_t i = 0; i < counts.size(); ++i)
    frame.position[i] = PeriodCounter::moved(frame.position[i], counts[i], box_.size());
}

}  // namespace twincell
