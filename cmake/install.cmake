# What `cmake --install` installs. The backends stand beside hbil.h, where they look for it. The .pc file goes by its
# own place, so that the whole may be moved.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package "${CMAKE_INSTALL_LIBDIR}/cmake/hbil")
install(FILES hbil.h DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
install(DIRECTORY backends/ DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" FILES_MATCHING PATTERN "*.h")
install(TARGETS hbil EXPORT hbilTargets INCLUDES DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
if(TARGET shadergen)
    install(TARGETS shadergen EXPORT hbilTargets RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
endif()
install(EXPORT hbilTargets NAMESPACE hbil:: DESTINATION "${package}")

write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/hbilConfigVersion.cmake" COMPATIBILITY SameMajorVersion
    ARCH_INDEPENDENT)
install(FILES cmake/hbilConfig.cmake cmake/hbil_add_shaders.cmake "${CMAKE_CURRENT_BINARY_DIR}/hbilConfigVersion.cmake"
    DESTINATION "${package}")

set(pc "${CMAKE_INSTALL_FULL_DATADIR}/pkgconfig")
file(RELATIVE_PATH HBIL_PC_TO_INCLUDE "${pc}" "${CMAKE_INSTALL_FULL_INCLUDEDIR}")
file(RELATIVE_PATH HBIL_PC_TO_BIN "${pc}" "${CMAKE_INSTALL_FULL_BINDIR}")
configure_file(cmake/hbil.pc.in hbil.pc @ONLY)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/hbil.pc" DESTINATION "${CMAKE_INSTALL_DATADIR}/pkgconfig")
