# find_package(hbil): hbil::hbil, hbil::shadergen where it was built, and hbil_add_shaders
include("${CMAKE_CURRENT_LIST_DIR}/hbilTargets.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/hbil_add_shaders.cmake")
