// Stand-in for rclcpp's logging: counts errors, and keeps the last texts of errors and information.
#pragma once

#include <cstdio>
#include <string>

#include "rclcpp/logger.hpp"

namespace rclcpp::stand_in {

inline int error_count = 0;
inline std::string last_error;

inline std::string last_info;

template <class... Arguments> std::string formatted(const char *format, Arguments... arguments) {
  char text[1024];
  std::snprintf(text, sizeof text, format, arguments...);
  return text;
}
template <class... Arguments> void log_error(const Logger &, const char *format, Arguments... arguments) {
  ++error_count;
  last_error = formatted(format, arguments...);
}
template <class... Arguments> void log_info(const Logger &, const char *format, Arguments... arguments) {
  last_info = formatted(format, arguments...);
}
inline void log_error(const Logger &, const char *text) {
  ++error_count;
  last_error = text;
}
/// Evaluates its arguments, so that they count as used.
template <class... Arguments> void log_nothing(const Logger &, const char *, Arguments...) {}

} // namespace rclcpp::stand_in

#define RCLCPP_ERROR(...) ::rclcpp::stand_in::log_error(__VA_ARGS__)
#define RCLCPP_INFO(...) ::rclcpp::stand_in::log_info(__VA_ARGS__)
#define RCLCPP_WARN(...) ::rclcpp::stand_in::log_nothing(__VA_ARGS__)
#define RCLCPP_DEBUG(...) ::rclcpp::stand_in::log_nothing(__VA_ARGS__)
