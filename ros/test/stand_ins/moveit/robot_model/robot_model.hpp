// Stand-in for MoveIt's robot model: the parsed URDF and groups that are chains.
#pragma once

#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include "moveit/robot_model/joint_model_group.hpp"

namespace moveit::core {

class RobotModel {
public:
  /// `model_frame` is the parent of the virtual joint to the root link; empty for the root link itself.
  explicit RobotModel(const std::string &urdf, const std::string &model_frame = "",
                      JointModel::JointType virtual_joint = JointModel::FIXED)
      : urdf_(urdf::parseURDF(urdf)), root_("virtual_joint", virtual_joint) {
    model_frame_ = model_frame.empty() ? urdf_->getRoot()->name : model_frame;
    for (const auto &[name, joint] : urdf_->joints_) {
      const auto [added, is_new] = joints_.emplace(name, JointModel(name, type(joint->type)));
      if (!is_new) continue;
      if (joint->type == urdf::Joint::CONTINUOUS) added->second.setVariableBounds(-M_PI, M_PI, false);
      else if (joint->limits) added->second.setVariableBounds(joint->limits->lower, joint->limits->upper);
    }
    for (const auto &[name, joint] : urdf_->joints_) {
      if (!joint->mimic) continue;
      const JointModel &source = joints_.at(joint->mimic->joint_name);
      joints_.at(name).setMimic(&source, joint->mimic->multiplier, joint->mimic->offset);
    }
  }
  /// Groups have pointers to joints, which a move leaves in place.
  RobotModel(RobotModel &&) = default;
  /// Adds the joints from a link to another.
  void addGroup(const std::string &name, const std::string &base, const std::string &tip, bool is_chain = true) {
    std::vector<const JointModel *> joints;
    std::vector<std::string> links;
    for (auto link = urdf_->getLink(tip); link->name != base; link = link->getParent()) {
      links.insert(links.begin(), link->name);
      joints.insert(joints.begin(), &joints_.at(link->parent_joint->name));
    }
    groups_.emplace(name, JointModelGroup(name, joints, links, is_chain));
  }
  JointModel &joint(const std::string &name) { return joints_.at(name); }

  const urdf::ModelInterfaceSharedPtr &getURDF() const { return urdf_; }
  const std::string &getModelFrame() const { return model_frame_; }
  const JointModel *getRootJoint() const { return &root_; }
  const JointModelGroup *getJointModelGroup(const std::string &name) const {
    const auto found = groups_.find(name);
    return found == groups_.end() ? nullptr : &found->second;
  }

private:
  static JointModel::JointType type(int type) {
    switch (type) {
    case urdf::Joint::REVOLUTE:
    case urdf::Joint::CONTINUOUS: return JointModel::REVOLUTE;
    case urdf::Joint::PRISMATIC: return JointModel::PRISMATIC;
    case urdf::Joint::PLANAR: return JointModel::PLANAR;
    case urdf::Joint::FLOATING: return JointModel::FLOATING;
    default: return JointModel::FIXED;
    }
  }

  urdf::ModelInterfaceSharedPtr urdf_;
  std::string model_frame_;
  JointModel root_;
  std::map<std::string, JointModel> joints_;
  std::map<std::string, JointModelGroup> groups_;
};

} // namespace moveit::core
