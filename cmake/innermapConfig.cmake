include("${CMAKE_CURRENT_LIST_DIR}/InnermapDependencies.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/innermapTargets.cmake")
