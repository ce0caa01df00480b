# SPDX-License-Identifier: Apache-2.0
handsel_test(trajectory SOURCES ${CMAKE_CURRENT_LIST_DIR}/trajectory/min_time_test.cpp ${CMAKE_CURRENT_LIST_DIR}/trajectory/trajectory_test.cpp ${CMAKE_CURRENT_LIST_DIR}/trajectory/time_scaling_test.cpp ${CMAKE_CURRENT_LIST_DIR}/trajectory/smooth_test.cpp ${CMAKE_CURRENT_LIST_DIR}/trajectory/approximate_test.cpp ${CMAKE_CURRENT_LIST_DIR}/../support/lane_level.cpp
  LINK handsel_trajectory LABEL unit)
handsel_test(trajectory_property SOURCES ${CMAKE_CURRENT_LIST_DIR}/../property/trajectory_property_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/../support/allocation_counter.cpp ${CMAKE_CURRENT_LIST_DIR}/../support/lane_level.cpp LINK handsel_trajectory LABEL property)
if(HANDSEL_RUCKIG)
  target_link_libraries(test_trajectory_property PRIVATE ruckig_peer)
endif()
# Ten million problems: some minutes of one core.
handsel_test_again(trajectory_ten_million OF trajectory_property FILTER "SevenAxes.end_together*")
set_tests_properties(trajectory_ten_million PROPERTIES LABELS full TIMEOUT 3600 ENVIRONMENT "HANDSEL_CASES=10000000;HANDSEL_SLOW=1000")
# A hundred thousand problems, all of them by the slow solver too.
handsel_test_again(trajectory_slow_solver OF trajectory_property FILTER "SevenAxes.end_together*")
set_tests_properties(trajectory_slow_solver PROPERTIES LABELS full TIMEOUT 1200 ENVIRONMENT "HANDSEL_CASES=100000;HANDSEL_SLOW=1")
# Registers narrower than this processor's widest.
foreach(level avx2 base)
  handsel_test_again(trajectory_lanes_${level} OF trajectory_property)
  set_tests_properties(trajectory_lanes_${level} PROPERTIES LABELS property SKIP_RETURN_CODE 77
    ENVIRONMENT "HANDSEL_LANES=${level};HANDSEL_CASES=20000;HANDSEL_SLOW=100")
  handsel_test_again(trajectory_path_${level} OF trajectory FILTER "Smooth.*:TimeScaling.*")
  set_tests_properties(trajectory_path_${level} PROPERTIES LABELS unit SKIP_RETURN_CODE 77 ENVIRONMENT "HANDSEL_LANES=${level};HANDSEL_RUNS=8")
  handsel_test_again(motion_stories_${level} OF motion_stories)
  set_tests_properties(motion_stories_${level} PROPERTIES LABELS property SKIP_RETURN_CODE 77 ENVIRONMENT "HANDSEL_LANES=${level};HANDSEL_RUNS=500")
endforeach()
