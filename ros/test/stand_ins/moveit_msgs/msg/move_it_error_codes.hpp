// Stand-in for the generated message: same field, and the values that plugins use.
#pragma once

#include <cstdint>

namespace moveit_msgs::msg {

struct MoveItErrorCodes {
  static constexpr int32_t SUCCESS = 1;
  static constexpr int32_t TIMED_OUT = -6;
  static constexpr int32_t GOAL_IN_COLLISION = -12;
  static constexpr int32_t NO_IK_SOLUTION = -31;
  int32_t val = 0;
};

} // namespace moveit_msgs::msg
