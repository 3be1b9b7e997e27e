# hbil_add_shaders(TARGET CONFIG FILE [FORMAT FORMAT] [OUTPUT NAME] [PASSES NAME ...] [HOOK FILE])
#
# Runs shadergen at build time, before TARGET is compiled, and again when FILE, the hook or shadergen has changed.
#
#   CONFIG  name=value pairs as shadergen reads them. Relative to the current source folder, as is HOOK
#   FORMAT  c (default): one header with all passes, in a folder that TARGET gets as an include directory.
#           spirv, glsl and all else that shadergen knows: a file for each pass, in a folder
#   OUTPUT  of c: name of the header, default hbil_shaders.h; else of the folder, default hbil_shaders
#   PASSES  only these; not with c. With spirv other rules can then depend on the files
#   HOOK    GLSL with the function of environment=hook
#
# All goes to TARGET.hbil/ in the binary folder of TARGET. Sets HBIL_SHADERS to the path of the header,
# or of the folder with a / at its end.
#
# shadergen is the one that hbil was installed or built with (HBIL_BUILD_SHADERGEN), or the program that HBIL_SHADERGEN
# names: where you cross-compile, one of the machine that builds.

# relative paths in depfiles mean the binary folder
if(POLICY CMP0116)
    cmake_policy(SET CMP0116 NEW)
endif()

function(hbil_add_shaders target)
    cmake_parse_arguments(PARSE_ARGV 1 S "" "CONFIG;FORMAT;OUTPUT;HOOK" "PASSES")
    if(S_UNPARSED_ARGUMENTS OR S_KEYWORDS_MISSING_VALUES OR NOT S_CONFIG)
        message(FATAL_ERROR "hbil_add_shaders(${ARGV}): CONFIG is missing, a value is (${S_KEYWORDS_MISSING_VALUES}), "
            "or an argument is not known (${S_UNPARSED_ARGUMENTS}). "
            "Usage: hbil_add_shaders(TARGET CONFIG FILE [FORMAT FORMAT] [OUTPUT NAME] [PASSES NAME ...] [HOOK FILE])")
    endif()
    if(NOT TARGET ${target})
        message(FATAL_ERROR "hbil_add_shaders: no target ${target}: call it after add_executable or add_library")
    endif()
    if(NOT S_FORMAT)
        set(S_FORMAT c)
    endif()
    if(S_FORMAT STREQUAL c AND S_PASSES)
        message(FATAL_ERROR "hbil_add_shaders: PASSES with FORMAT c: its header holds all passes; leave PASSES out")
    endif()
    if(HBIL_SHADERGEN)
        set(shadergen "${HBIL_SHADERGEN}")
    elseif(TARGET hbil::shadergen)
        set(shadergen $<TARGET_FILE:hbil::shadergen>)
    else()
        message(FATAL_ERROR "hbil_add_shaders: hbil came without shadergen. Set HBIL_BUILD_SHADERGEN to ON where "
            "hbil is built, or HBIL_SHADERGEN to the path of the program")
    endif()

    # where
    get_target_property(type ${target} TYPE)
    if(type STREQUAL INTERFACE_LIBRARY) # CMake before 3.19 does not tell its folder
        set(scope INTERFACE)
        set(folder "${CMAKE_CURRENT_BINARY_DIR}/${target}.hbil")
    else()
        set(scope PRIVATE)
        get_target_property(folder ${target} BINARY_DIR)
        set(folder "${folder}/${target}.hbil")
    endif()
    if(S_FORMAT STREQUAL c)
        if(NOT S_OUTPUT)
            set(S_OUTPUT hbil_shaders.h)
        endif()
        set(output "${folder}/${S_OUTPUT}")
        set(files "${output}")
        target_include_directories(${target} ${scope} "${folder}")
    else()
        if(NOT S_OUTPUT)
            set(S_OUTPUT hbil_shaders)
        endif()
        set(output "${folder}/${S_OUTPUT}/")
        set(files)
    endif()
    get_filename_component(parent "${folder}/${S_OUTPUT}" DIRECTORY)
    file(MAKE_DIRECTORY "${parent}")
    set(stamp "${folder}/${S_OUTPUT}.stamp")
    set(depfile "${folder}/${S_OUTPUT}.d")

    # from what
    get_filename_component(config "${S_CONFIG}" ABSOLUTE)
    set(sources "${config}" "${shadergen}")
    set(arguments -c "${config}" --format ${S_FORMAT} -o "${output}" --stamp "${stamp}" --depfile "${depfile}")
    if(S_HOOK)
        get_filename_component(hook "${S_HOOK}" ABSOLUTE)
        list(APPEND sources "${hook}")
        list(APPEND arguments --hook "${hook}")
    endif()
    set(depends DEPENDS ${sources})
    if(CMAKE_GENERATOR MATCHES Ninja OR (CMAKE_GENERATOR MATCHES Makefiles AND NOT CMAKE_VERSION VERSION_LESS 3.20))
        list(APPEND depends DEPFILE "${depfile}")
    endif()

    # a run a pass, or one for all. shadergen leaves files alone that would not change, so the stamp is what is new
    set(commands)
    foreach(pass IN LISTS S_PASSES)
        list(APPEND commands COMMAND "${shadergen}" ${arguments} --pass ${pass})
        if(S_FORMAT STREQUAL spirv)
            list(APPEND files "${output}${pass}.spv")
        endif()
    endforeach()
    if(NOT S_PASSES)
        list(APPEND commands COMMAND "${shadergen}" ${arguments})
    endif()
    if(files)
        set(files BYPRODUCTS ${files})
    endif()
    add_custom_command(OUTPUT "${stamp}" ${files} ${commands} COMMAND "${CMAKE_COMMAND}" -E touch "${stamp}" ${depends}
        COMMENT "shaders of ${target}: ${S_CONFIG}, ${S_FORMAT}" VERBATIM)
    string(MAKE_C_IDENTIFIER "${target}_${S_OUTPUT}" name)
    add_custom_target(${name} DEPENDS "${stamp}")
    add_dependencies(${target} ${name})
    set(HBIL_SHADERS "${output}" PARENT_SCOPE)
endfunction()
