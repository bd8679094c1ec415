// What a checkpoint holds of event-driven motion.

#include "sim/event_driven/event_loop.hpp"

namespace twincell::sim {

/// Writes or reads everything, beyond the beads, that event-driven motion depends on. \param k an event loop,
/// const for writing
template <class Self, class Archive>
void EventLoop::archive(Self& k, Archive& a) {
  a(k.base_), a(k.now_);
  for (std::size_t i = 0; i < k.beads_.paths.size(); ++i) {
    BallisticPath line = k.beads_.paths[i];
    a(line);
    if constexpr (Archive::kReads) k.beads_.paths.put(i, line);
    a(k.beads_.paths.valid_from(i)), a(k.beads_.rim[i]);
    Event event = k.events_[i];
    a(event.time), a(event.kind), a(event.partner);
    if constexpr (Archive::kReads) k.events_.put(i, event);
  }
  archive_size(k.contacts_, a);
  for (auto& c : k.contacts_) {
    a(c.i), a(c.j), a(c.begin), a(c.middle), a(c.end), a(c.from), a(c.until);
    a(c.motion.r), a(c.motion.u), a(c.motion.s), a(c.shift), a(c.about);
    for (std::size_t q = 0; q < 2; ++q) a(c.early[q]), a(c.late[q]), a(c.before[q]), a(c.rim[q]);
  }
  archive_size(k.clusters_, a);
  for (auto& c : k.clusters_) archive_cluster(k, c, a);
}

template <class Self, class Run, class Archive>
void EventLoop::archive_cluster(Self& k, Run& c, Archive& a) {
  auto& h = c.cluster;
  a(c.from), a(c.until);
  if constexpr (Archive::kReads) {
    h.start = k.frame_;
    h.start.forces_known = true;
  }
  archive_size(h.members, a);
  archive_size(h.memories, a);
  a(h.steps);
  std::int64_t since = k.base_ - h.start.step;
  a(since);
  const std::size_t n = h.members.size();
  if constexpr (Archive::kReads) {
    h.stray.resize(n), c.before.resize(n);
    h.start.beads.resize(n), h.start.forces.resize(n);
    h.start.step = k.base_ - since;
  }
  for (std::size_t i = 0; i < n; ++i) {
    auto& b = h.start.beads[i];
    auto& f = h.start.forces[i];
    a(h.members[i]), a(h.stray[i]), a(c.before[i]);
    a(b.x), a(b.y), a(b.z), a(b.vx), a(b.vy), a(b.vz), a(b.spin_x), a(b.spin), a(b.spin_z);
    a(b.radius), a(b.mass), a(b.inertia);
    a(f.x), a(f.y), a(f.z), a(f.q_x), a(f.q), a(f.q_z);
  }
  for (auto& m : h.memories) {
    a(m.i), a(m.j);
    archive_size(m.values, a);
    for (auto& v : m.values) a(v);
  }
}

void EventLoop::save(ArchiveWriter& out) const {
  archive(*this, out);
}

void EventLoop::load(ArchiveReader& in) {
  archive(*this, in);
}

}  // namespace twincell::sim
