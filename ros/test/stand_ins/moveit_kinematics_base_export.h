// Stand-in for the header that MoveIt's build generates.
#pragma once
#define MOVEIT_KINEMATICS_BASE_EXPORT
