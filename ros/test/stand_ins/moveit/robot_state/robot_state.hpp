// Stand-in for MoveIt's robot state: positions of the joints that were set.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "moveit/robot_model/robot_model.hpp"

namespace moveit::core {

class RobotState {
public:
  explicit RobotState(const std::shared_ptr<const RobotModel> &model) : model_(model) {}
  void setToDefaultValues() { positions_.clear(); }
  void setJointGroupPositions(const JointModelGroup *group, const std::vector<double> &values) {
    size_t next = 0;
    for (const JointModel *joint : group->getJointModels()) {
      if (joint->getVariableCount() == 1) positions_[joint->getName()] = values.at(next++);
    }
    is_updated_ = false;
  }
  void update() { is_updated_ = true; }
  /// Position of a joint with one variable; for the test.
  double position(const std::string &joint) const { return is_updated_ ? positions_.at(joint) : std::stod("nan"); }

private:
  std::shared_ptr<const RobotModel> model_;
  std::map<std::string, double> positions_;
  bool is_updated_ = false;
};

} // namespace moveit::core
