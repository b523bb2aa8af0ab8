// Definitions of the stand-ins.
#include <moveit/utils/logger.hpp>

namespace moveit {

rclcpp::Logger getLogger(const std::string &name) { return rclcpp::Logger(name); }

} // namespace moveit
