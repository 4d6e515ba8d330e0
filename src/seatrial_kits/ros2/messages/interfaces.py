"""Definitions that the stores of rosbags lack, by name: fields alone, of a service two parts, of an
action three.

simulation_interfaces 1.x (Apache-2.0, https://github.com/ros-simulation/simulation_interfaces),
marine_acoustic_msgs (BSD-3-Clause, https://github.com/apl-ocean-engineering/marine_msgs),
nmea_msgs (BSD-3-Clause, https://github.com/ros-drivers/nmea_msgs),
ros_gz_interfaces (Apache-2.0, https://github.com/gazebosim/ros_gz), rcl_interfaces and
action_msgs (Apache-2.0).
A module, and no files: FMUs take modules along.
"""

from __future__ import annotations

from collections.abc import Mapping

INTERFACES: Mapping[str, str] = {
    "rcl_interfaces/srv/SetParameters": """\
Parameter[] parameters
---
SetParametersResult[] results
""",
    "action_msgs/srv/CancelGoal": """\
GoalInfo goal_info
---
int8 return_code
GoalInfo[] goals_canceling
""",
    "marine_acoustic_msgs/msg/Dvl": """\
std_msgs/Header header
uint8 velocity_mode
uint8 dvl_type
geometry_msgs/Vector3 velocity
float64[9] velocity_covar
float64 altitude
float64 course_gnd
float64 speed_gnd
uint8 num_good_beams
float32 sound_speed
bool beam_ranges_valid
bool beam_velocities_valid
geometry_msgs/Vector3[4] beam_unit_vec
float64[4] range
float32[4] range_covar
float32[4] beam_quality
float32[4] beam_velocity
float32[4] beam_velocity_covar
""",
    "nmea_msgs/msg/Sentence": """\
std_msgs/Header header
string sentence
""",
    "ros_gz_interfaces/msg/Float32Array": """\
float32[] data
""",
    "ros_gz_interfaces/msg/ParamVec": """\
std_msgs/Header header
rcl_interfaces/Parameter[] params
""",
    "simulation_interfaces/action/SimulateSteps": """\
uint64 steps
---
Result result
---
uint64 completed_steps
uint64 remaining_steps
""",
    "simulation_interfaces/msg/Bounds": """\
uint8 type
geometry_msgs/Vector3[] points
""",
    "simulation_interfaces/msg/EntityCategory": """\
uint8 category
""",
    "simulation_interfaces/msg/EntityFilters": """\
string filter
EntityCategory[] categories
TagsFilter tags
Bounds bounds
""",
    "simulation_interfaces/msg/EntityState": """\
std_msgs/Header header
geometry_msgs/Pose pose
geometry_msgs/Twist twist
geometry_msgs/Accel acceleration
""",
    "simulation_interfaces/msg/Resource": """\
string uri
string resource_string
""",
    "simulation_interfaces/msg/Result": """\
uint8 result
string error_message
""",
    "simulation_interfaces/msg/SimulationState": """\
uint8 state
""",
    "simulation_interfaces/msg/SimulatorFeatures": """\
uint16[] features
string[] spawn_formats
string custom_info
""",
    "simulation_interfaces/msg/Spawnable": """\
string uri
string description
Bounds spawn_bounds
""",
    "simulation_interfaces/msg/TagsFilter": """\
string[] tags
uint8 filter_mode
""",
    "simulation_interfaces/msg/WorldResource": """\
string name
Resource world_resource
string description
string[] tags
""",
    "simulation_interfaces/srv/DeleteEntity": """\
string entity
---
Result result
""",
    "simulation_interfaces/srv/GetAvailableWorlds": """\
string[] additional_sources
TagsFilter filter
bool offline_only
bool continue_on_error
---
Result result
WorldResource[] worlds
""",
    "simulation_interfaces/srv/GetCurrentWorld": """\
---
Result result
WorldResource world
""",
    "simulation_interfaces/srv/GetEntities": """\
EntityFilters filters
---
Result result
string[] entities
""",
    "simulation_interfaces/srv/GetEntitiesStates": """\
EntityFilters filters
---
Result result
string[] entities
EntityState[] states
""",
    "simulation_interfaces/srv/GetEntityState": """\
string entity
---
Result result
EntityState state
""",
    "simulation_interfaces/srv/GetSimulationState": """\
---
SimulationState state
Result result
""",
    "simulation_interfaces/srv/GetSimulatorFeatures": """\
---
SimulatorFeatures features
""",
    "simulation_interfaces/srv/GetSpawnables": """\
string[] sources
---
Result result
Spawnable[] spawnables
""",
    "simulation_interfaces/srv/LoadWorld": """\
string uri
string resource_string
bool fail_on_unsupported_element
bool ignore_missing_or_unsupported_assets
---
Result result
WorldResource world
""",
    "simulation_interfaces/srv/ResetSimulation": """\
uint8 scope
---
Result result
""",
    "simulation_interfaces/srv/SetEntityState": """\
string entity
EntityState state
---
Result result
""",
    "simulation_interfaces/srv/SetSimulationState": """\
SimulationState state
---
Result result
""",
    "simulation_interfaces/srv/SpawnEntity": """\
string name
bool allow_renaming
string uri
string resource_string
string entity_namespace
geometry_msgs/PoseStamped initial_pose
---
Result result
string entity_name
""",
    "simulation_interfaces/srv/StepSimulation": """\
uint64 steps 1
---
Result result
""",
}
