#!/bin/bash
# Builds an rclpy of ROS 2 outside of the repository, with rmw_cyclonedds, in Humble rmw_fastrtps too, and
# the messages that test_rclpy.py has: bash tests/kits/ros2/build_rclpy.sh FOLDER [humble|jazzy]; then
# SEATRIAL_ROS2=FOLDER make test-long. For Debian 12 with its Python 3.11; a quarter of an hour on two cores.
#
# ROS2_SOURCES names a folder with clones of the repositories, if GitHub is not to be asked.
set -e
work=$(realpath -m "${1:?the folder to build in}")
apt-get install -y -qq cmake g++ git ninja-build python3-venv python3-dev cyclonedds-dev cyclonedds-tools \
    libcycloneddsidl0 libfastcdr-dev libfastrtps-dev libyaml-dev pybind11-dev libasio-dev libtinyxml2-dev libssl-dev
distribution=${2:-humble}
mkdir -p "$work/src" && cd "$work"
echo "$distribution" > distribution
/usr/bin/python3 -m venv v  # the system's Python: CMake's modules look for that
touch v/COLCON_IGNORE
v/bin/pip install -q colcon-common-extensions "empy==3.3.4" "lark<1.2" "numpy<2" catkin_pkg pyyaml "setuptools<70" packaging
middlewares=(rmw_cyclonedds_cpp) more=(ros2/{rosidl_core,rosidl_dynamic_typesupport} eProsima/Fast-CDR)
if [ "$distribution" = humble ]; then  # Debian's Fast DDS is that of Humble
    middlewares+=(rmw_fastrtps_cpp) more=(ros2/rmw_fastrtps)
fi
for repository in ament/{ament_cmake,ament_package,ament_index} ros2/{ament_cmake_ros,rcutils,rcpputils,rmw} \
    ros2/{rmw_implementation,rmw_dds_common,rosidl,rosidl_defaults,rosidl_typesupport,rosidl_typesupport_fastrtps} \
    ros2/{rosidl_python,rcl,rcl_interfaces,rcl_logging,rclpy,rmw_cyclonedds,common_interfaces,ros2_tracing} \
    ros2/{unique_identifier_msgs,libyaml_vendor,rpyutils,pybind11_vendor,python_cmake_module,rosidl_runtime_py} \
    ros2/geometry2 ros-simulation/simulation_interfaces "${more[@]}"; do
    name=${repository##*/}
    from=${ROS2_SOURCES:+$ROS2_SOURCES/$name}
    [ -d "src/$name" ] || git clone -q "${from:-https://github.com/$repository}" "src/$name"
    wanted=$distribution
    [ "$name" != Fast-CDR ] || wanted=v2.2.2
    git -C "src/$name" checkout -q "$wanted" 2>/dev/null || git -C "src/$name" checkout -q rolling
done
if [ -n "$ROS2_SOURCES" ]; then  # libyaml_vendor clones libyaml
    export GIT_CONFIG_COUNT=1 GIT_CONFIG_KEY_0="url.file://$ROS2_SOURCES/libyaml.insteadOf"
    export GIT_CONFIG_VALUE_0="https://github.com/yaml/libyaml.git"
fi
[ ! -d src/rmw_fastrtps ] || touch src/rmw_fastrtps/rmw_fastrtps_dynamic_cpp/COLCON_IGNORE
touch src/rcl_logging/rcl_logging_spdlog/COLCON_IGNORE src/rcl_interfaces/test_msgs/COLCON_IGNORE
touch src/common_interfaces/{common_interfaces,sensor_msgs_py}/COLCON_IGNORE
for folder in src/ros2_tracing/*/; do [ "$folder" = src/ros2_tracing/tracetools/ ] || touch "$folder/COLCON_IGNORE"; done
for folder in src/geometry2/*/; do [ "$folder" = src/geometry2/tf2_msgs/ ] || touch "$folder/COLCON_IGNORE"; done
# Messages that no test has take most of the time.
kept='msg/(Accel|BatteryState|Bool|Float32|Float64|FluidPressure|Header|Imu|JointState|LaserScan|MagneticField'
kept+='|NavSatFix|NavSatStatus|Odometry|Path|Point|Pose|PoseArray|PoseStamped|PoseWithCovariance|Quaternion|Range'
kept+='|String|Temperature|Transform|TransformStamped|Twist|TwistStamped|TwistWithCovariance'
kept+='|TwistWithCovarianceStamped|Vector3|Wrench|WrenchStamped)\.'
for file in src/common_interfaces/{std,geometry,nav,sensor}_msgs/CMakeLists.txt; do
    awk -v kept="$kept" '!/"(msg|srv|action)\// || $0 ~ kept' "$file" > "$file.kept" && mv "$file.kept" "$file"
    grep -q '"srv/' "$file" || sed -i '/\${srv_files}/d' "$file"
    sed -i '/\${action_files}/d' "$file"
done
. v/bin/activate
export RCL_LOGGING_IMPLEMENTATION=rcl_logging_noop MAKEFLAGS=-j2
colcon build --merge-install --executor sequential --event-handlers console_cohesion- --packages-skip-build-finished \
    --packages-up-to rclpy "${middlewares[@]}" rcl_logging_noop \
    sensor_msgs nav_msgs geometry_msgs std_srvs diagnostic_msgs tf2_msgs simulation_interfaces \
    --cmake-args -DBUILD_TESTING=OFF -DCMAKE_BUILD_TYPE=Release -DTRACETOOLS_DISABLED=ON \
    -DRCL_LOGGING_IMPLEMENTATION=rcl_logging_noop -DPython3_EXECUTABLE="$work/v/bin/python3" \
    -DPYTHON_EXECUTABLE="$work/v/bin/python3" -DPython3_FIND_VIRTUALENV=FIRST
