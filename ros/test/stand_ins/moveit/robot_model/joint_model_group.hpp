// Stand-in for MoveIt's groups: a list of joints, and of the links that they move.
#pragma once

#include <string>
#include <vector>

#include "moveit/robot_model/joint_model.hpp"

namespace moveit::core {

class JointModelGroup {
public:
  JointModelGroup(const std::string &name, std::vector<const JointModel *> joints, std::vector<std::string> links,
                  bool is_chain)
      : name_(name), joints_(std::move(joints)), links_(std::move(links)), is_chain_(is_chain) {}
  const std::string &getName() const { return name_; }
  bool isChain() const { return is_chain_; }
  bool isSingleDOFJoints() const {
    for (const JointModel *joint : joints_) {
      if (joint->getVariableCount() > 1) return false;
    }
    return true;
  }
  const std::vector<const JointModel *> &getJointModels() const { return joints_; }
  const std::vector<std::string> &getLinkModelNames() const { return links_; }
  bool hasJointModel(const std::string &name) const { return getJointModel(name) != nullptr; }
  const JointModel *getJointModel(const std::string &name) const {
    for (const JointModel *joint : joints_) {
      if (joint->getName() == name) return joint;
    }
    return nullptr;
  }

private:
  std::string name_;
  std::vector<const JointModel *> joints_;
  std::vector<std::string> links_;
  bool is_chain_;
};

} // namespace moveit::core
