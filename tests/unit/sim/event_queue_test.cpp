// Which event comes first, and which beads search again after a bead has changed its path.

#include "sim/event_driven/event_queue.hpp"

#include <gtest/gtest.h>

#include <random>

namespace twincell::sim::event_queue_test {
namespace {

using Kind = Event::Kind;

TEST(EventQueue, FindsTheEarliestEvent) {
  std::mt19937_64 random(3);
  for (const std::size_t beads : {1U, 2U, 7U, 16U, 101U}) {
    EventQueue schedule;
    schedule.clear(beads);
    EXPECT_EQ(schedule.soonest(), 0U);              // no event at all
    std::uniform_int_distribution<int> time(0, 9);  // many events at the same time
    for (std::size_t i = 0; i < beads; ++i)
      schedule.put(i, {static_cast<double>(time(random)), Kind::wall, -1});
    std::size_t first = 0;
    for (std::size_t i = 1; i < beads; ++i)
      if (schedule[i].time < schedule[first].time) first = i;
    EXPECT_EQ(schedule.soonest(), first) << beads;
  }
}

TEST(EventQueue, PartnersOfAChangedBeadAreRescheduled) {
  EventQueue schedule;
  schedule.clear(5);
  schedule.put(0, {2, Kind::touch, 3});
  schedule.put(3, {2, Kind::touch, 0});  // each is the other's predicted partner
  schedule.put(1, {4, Kind::touch, 3});
  schedule.put(2, {5, Kind::touch, 1});
  schedule.put(4, {1, Kind::wall, -4});
  schedule.put_off(3);
  EXPECT_EQ(schedule[0].kind, Kind::touch);
  EXPECT_EQ(schedule[3].kind, Kind::touch);
  EXPECT_EQ(schedule[1].kind, Kind::look_again);
  EXPECT_EQ(schedule[1].time, 4);
  EXPECT_EQ(schedule[2].kind, Kind::touch);  // with a bead that did not change
  EXPECT_EQ(schedule[4].kind, Kind::wall);
  schedule.set_back(1);
  EXPECT_EQ(schedule[1].time, 3);
  EXPECT_EQ(schedule[4].time, 0);
  schedule.put(3, {2, Kind::touch, 2});
  schedule.put_off(3);
  EXPECT_EQ(schedule[0].kind, Kind::look_again);
}

}  // namespace
}  // namespace twincell::sim::event_queue_test
