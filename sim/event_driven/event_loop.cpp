#include "sim/event_driven/event_loop.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace twincell::sim {

namespace {

constexpr std::size_t kMaxInCluster = 8;  // with more members, all beads are advanced by steps

}  // namespace

EventLoop::EventLoop(const Plan& plan, const GuardLimits& limits, const System& s, MakeSolver few)
    : plan_(plan),
      limits_(limits),
      make_few_(std::move(few)),
      beads_(plan, s, static_cast<double>(s.step % s.steps_per_period) * s.dt),
      frame_(s),
      dt_(s.dt),
      per_period_(s.steps_per_period),
      base_(s.step / per_period_ * per_period_) {
  now_ = static_cast<double>(s.step - base_) * dt_;
  events_.clear(s.beads.size());
  frame_.beads.clear(), frame_.forces.clear(), frame_.rim_speeds.clear();
}

Solver::Footprint EventLoop::footprint() const {
  constexpr std::size_t kNumbers = 6 + 2 + 3 + 2;  // path, radius and valid_from, rim, mass and turn
  return {beads_.mass.size() * (kNumbers * sizeof(double) + sizeof(Event)),
          contacts_.size() * sizeof(BinaryContact), contacts_.size()};
}

bool EventLoop::begin(const std::vector<std::pair<std::int32_t, std::int32_t>>& touching) {
  for (const auto& [i, j] : touching)
    if (!begin_contact(i, j)) return false;
  for (std::size_t i = 0; i < beads_.mass.size(); ++i)
    if (!find_next_event(i)) return false;
  return true;
}

bool EventLoop::advance(System& s, std::int64_t last) {
  const std::int64_t stop = std::min(last, base_ + per_period_);
  const double until = static_cast<double>(stop - base_) * dt_;
  for (;;) {
    const std::size_t i = events_.soonest();
    const Event next = events_[i];
    if (!(next.time < until)) break;
    now_ = std::max(now_, next.time);
    if (!handle(i, next)) {
      s.step = std::max(s.step, base_ + step_before(now_));
      if (resolve_cluster(s)) continue;
      return false;
    }
  }
  now_ = until;
  s.step = stop;
  if (stop == base_ + per_period_) begin_period();
  return true;
}

/// Moves the origin of time by one period and removes completed contacts and clusters.
void EventLoop::begin_period() {
  const double period = static_cast<double>(per_period_) * dt_;
  base_ += per_period_;
  now_ -= period;
  std::erase_if(contacts_, [&](const BinaryContact& c) { return c.until <= now_ + period; });
  std::erase_if(clusters_, [&](const ClusterRun& c) { return c.until <= now_ + period; });
  events_.set_back(period);
  beads_.move_origin(period);
  for (BinaryContact& c : contacts_) {
    c.begin -= period, c.middle -= period, c.end -= period, c.from -= period, c.until -= period;
    for (BallisticPath& line : c.before) line = line.later(period, beads_.gravity);
  }
  for (ClusterRun& c : clusters_) {
    c.from -= period, c.until -= period;
    for (BallisticPath& line : c.before) line = line.later(period, beads_.gravity);
  }
}

/// Handles an event. \returns false if three bodies meet; `cluster_` then contains some of them
bool EventLoop::handle(std::size_t i, Event event) {
  switch (event.kind) {
    case Event::Kind::look_again:
      return find_next_event(i);
    case Event::Kind::wall:
      return begin_contact(static_cast<std::int32_t>(i), event.partner) && find_next_events(i, i);
    case Event::Kind::touch: {
      const auto j = static_cast<std::size_t>(event.partner);
      return begin_contact(static_cast<std::int32_t>(std::min(i, j)),
                           static_cast<std::int32_t>(std::max(i, j))) &&
             find_next_events(i, j);
    }
    case Event::Kind::none:
      break;
  }
  return true;
}

/// Finds the next events of two beads with new paths.
bool EventLoop::find_next_events(std::size_t i, std::size_t j) {
  events_.put(i, {}), events_.put(j, {});
  if (!find_next_event(i) || (j != i && !find_next_event(j))) return false;
  for (const std::size_t changed : {i, j}) events_.put_off(changed);
  return true;
}

/// Finds the next event of bead i on its present path. \returns false if three bodies meet
bool EventLoop::find_next_event(std::size_t i) {
  const BallisticPaths::Hit hit = beads_.paths.first_hit(i, now_);
  const double from = std::max(now_, beads_.paths.valid_from(i));
  if (hit.overlap) {
    cluster_ = {static_cast<std::int32_t>(i)};
    const PathInterval here{cluster_.front(), beads_.paths[i], beads_.paths.radius(i), from, from};
    add_near({&here, 1});
    return false;
  }
  Event event;
  if (hit.time < event.time) event = {hit.time, Event::Kind::touch, hit.partner};
  if (hit.until < event.time) event = {hit.until, Event::Kind::look_again, -1};
  for (std::size_t w = 0; w < beads_.walls.size(); ++w) {
    if (beads_.in_wall(i, beads_.walls[w], from)) {
      cluster_ = {static_cast<std::int32_t>(i)};
      return false;
    }
    if (const double t = beads_.wall_touch(i, beads_.walls[w], from, event.time); t < event.time)
      event = {t, Event::Kind::wall, -1 - static_cast<std::int32_t>(w)};
  }
  cluster_ = {static_cast<std::int32_t>(i)};
  const PathInterval own{cluster_.front(), beads_.paths[i], beads_.paths.radius(i), now_, HUGE_VAL};
  if (add_near_interactions(own, {&own, 1})) return false;
  events_.put(i, event);
  if (event.kind == Event::Kind::touch) {
    const auto other = static_cast<std::size_t>(event.partner);
    if (event.time < events_[other].time)
      events_.put(other, {event.time, Event::Kind::touch, static_cast<std::int32_t>(i)});
  }
  return true;
}

/// Calls visit(bead) for each member of a contact or cluster.
template <class Visit>
void EventLoop::visit_members(const BinaryContact& c, Visit visit) {
  visit(c.i);
  if (c.j >= 0) visit(c.j);
}

template <class Visit>
void EventLoop::visit_members(const ClusterRun& c, Visit visit) {
  for (const std::int32_t k : c.cluster.members) visit(k);
}

/// Calls visit(interval) for the intervals of these beads, until they are on their paths after the contact or
/// cluster.
template <class Visit>
void EventLoop::visit_intervals(const BinaryContact& c, const std::array<BallisticPath, 2>& after,
                                Visit visit) const {
  for (std::size_t q = 0; q < (c.j < 0 ? 1u : 2u); ++q) {
    const std::int32_t k = q == 0 ? c.i : c.j;
    const double radius = beads_.paths.radius(static_cast<std::size_t>(k));
    visit(PathInterval{k, c.before[q], radius + c.early[q], c.from, c.middle});
    visit(PathInterval{k, after[q], radius + c.late[q], c.middle, c.until});
  }
}

template <class Visit>
void EventLoop::visit_intervals(const BinaryContact& c, Visit visit) const {
  const auto line = [&](std::int32_t k) { return beads_.paths[static_cast<std::size_t>(std::max(0, k))]; };
  visit_intervals(c, {line(c.i), line(c.j)}, visit);
}

template <class Visit>
void EventLoop::visit_intervals(const ClusterRun& c, Visit visit) const {
  for (std::size_t k = 0; k < c.cluster.members.size(); ++k) {
    const std::int32_t bead = c.cluster.members[k];
    const double radius = beads_.paths.radius(static_cast<std::size_t>(bead));
    visit(PathInterval{bead, c.before[k], radius + c.cluster.stray[k], c.from, c.until});
  }
}

/// Calls visit(interaction) for contacts and clusters in progress.
template <class Visit>
void EventLoop::visit_interactions(Visit visit) const {
  for (const BinaryContact& c : contacts_)
    if (c.until > now_) visit(c);
  for (const ClusterRun& c : clusters_)
    if (c.until > now_) visit(c);
}

bool EventLoop::in_cluster(std::int32_t bead) const {
  return std::find(cluster_.begin(), cluster_.end(), bead) != cluster_.end();
}

/// An interval that encloses a contact or cluster from its beginning to its end.
PathInterval EventLoop::whole(const BinaryContact& c) {
  return {c.i, c.before[0], c.about, c.from, c.until};
}

PathInterval EventLoop::whole(const ClusterRun& c) {
  return {c.cluster.members.front(), c.before.front(), HUGE_VAL, c.from, c.until};
}

/// For each contact or cluster without members in `cluster_`, adds one of its beads to `cluster_` if that
/// bead may touch one of the intervals from now on. \param all an interval that encloses all intervals
/// \returns whether a bead was added
bool EventLoop::add_near_interactions(const PathInterval& all, std::span<const PathInterval> intervals) {
  const std::size_t before = cluster_.size();
  const auto near = [&](const PathInterval& p, const PathInterval& q) {
    const double begin = std::max({now_, p.begin, q.begin}), end = std::min(p.end, q.end);
    return begin <= end && beads_.come_near(p, q, begin, end);
  };
  visit_interactions([&](const auto& interaction) {
    if (!near(all, whole(interaction))) return;
    bool own = false;
    visit_members(interaction, [&](std::int32_t k) { own = own || in_cluster(k); });
    if (own) return;
    std::int32_t found = -1;
    visit_intervals(interaction, [&](const PathInterval& other) {
      if (std::any_of(intervals.begin(), intervals.end(),
                      [&](const PathInterval& p) { return near(p, other); }))
        found = other.bead;
    });
    if (found >= 0) cluster_.push_back(found);
  });
  return cluster_.size() > before;
}

/// Adds to `cluster_` the beads whose paths may touch one of the intervals. The intervals of one bead must be
/// consecutive.
/// \returns whether a bead was added
bool EventLoop::add_near(std::span<const PathInterval> intervals) {
  const std::size_t before = cluster_.size();
  while (!intervals.empty()) {
    const PathInterval& first = intervals.front();
    std::size_t own = 1;
    while (own < intervals.size() && intervals[own].bead == first.bead) ++own;
    add_near_one(intervals.first(own));
    intervals = intervals.subspan(own);
  }
  return cluster_.size() > before;
}

void EventLoop::add_near_one(std::span<const PathInterval> intervals) {
  // First a SIMD search for candidates: beads within a ball that contains all intervals and moves along the
  // first path.
  const PathInterval &first = intervals.front(), &last = intervals.back();
  double reach = first.radius;
  for (const PathInterval& p : intervals.subspan(1))
    for (const double t : {p.begin, p.end}) reach = std::max(reach, p.radius + beads_.distance(p, first, t));
  near_.clear();
  beads_.paths.find_near(first.line, reach, first.begin, last.end, near_);
  for (const std::int32_t k : near_) {
    if (in_cluster(k)) continue;
    const auto i = static_cast<std::size_t>(k);
    const PathInterval other{k, beads_.paths[i], beads_.paths.radius(i), 0, 0};
    if (std::any_of(intervals.begin(), intervals.end(),
                    [&](const PathInterval& p) { return beads_.come_near(p, other, p.begin, p.end); }))
      cluster_.push_back(k);
  }
}

// --- binary collisions ---
/// Integrates a contact of two bodies that touch, or are in contact, now, to its end, and sets their paths
/// after it.
/// \returns false if the contact does not end or another body may touch one of the beads
bool EventLoop::begin_contact(std::int32_t i, std::int32_t j) {
  BinaryContact c{};
  c.i = i, c.j = j;
  c.begin = now_;
  // Relative motion at the present time.
  const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(std::max(0, j));
  c.before = {beads_.paths[a], j < 0 ? BallisticPath{} : beads_.paths[b]};
  c.rim = {beads_.rim[a], j < 0 ? Vec3::Zero().eval() : beads_.rim[b]};
  const CollisionSetting e = beads_.setting(i, j);
  c.motion = beads_.relative_motion(c, now_);
  // Integration. If the contact rests or is too deep, all beads are advanced by steps: `cluster_` stays
  // empty.
  const double speed = c.motion.u.norm();
  const CollisionEnd end = integrate_collision(
      e, c.motion, now_, now_ + kLongestContact * collision_time(e, std::max(speed, 1e-3)), kTolerance);
  cluster_.clear();
  if (!end.parted || end.deepest > limits_.overlap) return false;
  // Paths after the contact, and the deviations from both paths.
  c.end = end.time;
  c.from = static_cast<double>(step_before(c.begin)) * dt_;
  c.until = static_cast<double>(step_before(c.end) + 1) * dt_;
  c.middle = end.middle;
  const auto halfway = beads_.states_of(c, end.at_middle, end.middle),
             after = beads_.states_of(c, end.motion, end.time);
  std::array<BallisticPath, 2> lines{};
  for (std::size_t q = 0; q < (j < 0 ? 1u : 2u); ++q) {
    lines[q] = BallisticPath::through(after[q].r, after[q].v, c.end, beads_.gravity);
    // The direction of the force changes little, so a bead moves ever farther from the path; the deviation
    // is largest at the middle.
    const auto off = [&](const BallisticPath& line) {
      return 1.05 * (halfway[q].r - line.position(c.middle, beads_.gravity)).norm();
    };
    c.early[q] = off(c.before[q]), c.late[q] = off(lines[q]);
  }
  // Third bodies: any bead, contact, cluster or wall that the beads may touch while they are in contact.
  cluster_ = {i};
  if (j >= 0) cluster_.push_back(j);
  intervals_.clear();
  visit_intervals(c, lines, [&](const PathInterval& p) {
    intervals_.push_back(p);
    intervals_.back().begin = std::max(p.begin, now_);
  });
  for (const PathInterval& p : intervals_)
    for (const double t : {p.begin, p.end})
      c.about = std::max(c.about, p.radius + beads_.distance(p, intervals_.front(), t));
  bool alone = !add_near(intervals_);
  alone = !add_near_interactions(whole(c), intervals_) && alone;
  // A bead in contact with another body and near a wall counts as three bodies too.
  for (std::size_t w = 0; w < beads_.walls.size(); ++w)
    if (j != -1 - static_cast<std::int32_t>(w) && beads_.reaches(whole(c), beads_.walls[w]))
      alone = alone && std::none_of(intervals_.begin(), intervals_.end(), [&](const PathInterval& p) {
                return beads_.reaches(p, beads_.walls[w]);
              });
  if (!alone) return false;
  // Accepted: the paths after the contact become the present ones.
  beads_.paths.put(a, lines[0]);
  beads_.paths.valid_from(a) = c.until;
  beads_.rim[a] = after[0].rim;
  if (j >= 0) {
    beads_.paths.put(b, lines[1]);
    beads_.paths.valid_from(b) = c.until;
    beads_.rim[b] = after[1].rim;
  }
  std::erase_if(contacts_, [&](const BinaryContact& old) { return old.until <= now_; });
  contacts_.push_back(c);
  return true;
}

// --- clusters ---
/// Extracts a cluster at the present step of the system (the beads of `cluster_`, the beads in contact with
/// them, and the beads that may touch them) and advances it by time steps until its beads have parted.
/// \returns false if they do not part or are too many; the contacts are then unchanged
bool EventLoop::resolve_cluster(System& s) {
  if (cluster_.empty()) return false;
  write(s);
  const double from = static_cast<double>(s.step - base_) * dt_;
  const auto contact = std::max<std::int64_t>(1, std::llround(plan_.shortest().time / dt_));
  std::vector<std::int32_t> members;
  for (;;) {
    const std::vector<std::int32_t> more = cluster_;
    cluster_ = members;
    for (const std::int32_t k : more)
      if (!in_cluster(k)) cluster_.push_back(k);
    add_partners(from);
    if (cluster_.size() == members.size() || cluster_.size() > kMaxInCluster) return false;
    members = cluster_;
    std::sort(cluster_.begin(), cluster_.end());
    ClusterRun c{take_out(s, memories_, cluster_), from, 0, {}};
    const auto end =
        separate_cluster(c.cluster, contact, static_cast<std::int64_t>(kLongestContact) * contact, make_few_);
    if (!end) return false;
    c.until = static_cast<double>(s.step + c.cluster.steps - base_) * dt_;
    for (const Bead& b : c.cluster.start.beads) c.before.push_back(beads_.path_of(b, from));
    intervals_.clear();
    visit_intervals(c, [&](const PathInterval& p) { intervals_.push_back(p); });
    bool alone = !add_near(intervals_);
    alone = !add_near_interactions(whole(c), intervals_) && alone;
    if (alone && end_cluster(std::move(c), *end)) return true;
  }
}

/// Adds to `cluster_` every bead in contact, or in a cluster, with a bead of `cluster_`.
void EventLoop::add_partners(double from) {
  for (bool grown = true; grown;) {
    grown = false;
    const auto add_all = [&](const auto& interaction) {
      bool own = false;
      visit_members(interaction, [&](std::int32_t k) { own = own || in_cluster(k); });
      if (!own || interaction.until <= from) return;
      visit_members(interaction, [&](std::int32_t k) {
        if (!in_cluster(k)) cluster_.push_back(k), grown = true;
      });
    };
    for (const BinaryContact& c : contacts_) add_all(c);
    for (const ClusterRun& c : clusters_) add_all(c);
  }
}

/// Sets the paths of the members after their cluster. \returns false if they then meet other bodies at
/// once; `cluster_` contains some of these
bool EventLoop::end_cluster(ClusterRun run, const System& end) {
  const std::vector<std::int32_t> members = run.cluster.members;
  const auto within = [&](std::int32_t k) { return std::binary_search(members.begin(), members.end(), k); };
  std::erase_if(contacts_, [&](const BinaryContact& c) { return c.until > run.from && within(c.i); });
  std::erase_if(clusters_,
                [&](const ClusterRun& c) { return c.until > run.from && within(c.cluster.members.front()); });
  for (std::size_t k = 0; k < members.size(); ++k) {
    const auto i = static_cast<std::size_t>(members[k]);
    beads_.set_path(i, end, k, run.until);
    events_.put(i, {});
  }
  clusters_.push_back(std::move(run));
  for (const std::int32_t k : members)
    if (!find_next_event(static_cast<std::size_t>(k))) return false;
  for (const std::int32_t k : members) events_.put_off(static_cast<std::size_t>(k));
  return true;
}

/// The last whole step, counted from the start of this period, at or before a time.
std::int64_t EventLoop::step_before(double t) const {
  auto k = static_cast<std::int64_t>(std::floor(t / dt_));
  if (static_cast<double>(k + 1) * dt_ <= t) ++k;
  if (static_cast<double>(k) * dt_ > t) --k;
  return k;
}

}  // namespace twincell::sim
