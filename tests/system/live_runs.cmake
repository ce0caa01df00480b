handsel_test(live_runs SOURCES ${CMAKE_CURRENT_LIST_DIR}/live_runs_test.cpp LINK handsel_lockstep handsel_path_planner_core LABEL system)
set_tests_properties(live_runs PROPERTIES PROCESSORS 2 TIMEOUT 300)
add_test(NAME live_runs_500 COMMAND test_live_runs)
set_tests_properties(live_runs_500 PROPERTIES LABELS full PROCESSORS 2 TIMEOUT 7200 ENVIRONMENT HANDSEL_RUNS=500)
