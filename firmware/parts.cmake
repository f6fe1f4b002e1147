# The parts of the firmware: the core, and extensions that nobody has to take along. Whatever builds
# or packs it reads them here.
set(SKIPLATCH_EXTENSIONS kinematics pretravel transmission injection)
set(SKIPLATCH_core input/*.c report/*.c cycle/touch_cycle*.c cycle/overtravel.c)
set(SKIPLATCH_kinematics comp/kinematics*.c cycle/kinematics*.c cycle/sphere_probe.c)
set(SKIPLATCH_pretravel comp/pretravel*.c)
set(SKIPLATCH_transmission comp/transmission*.c comp/pulse_judge.c comp/phase_meter.c transmission/*.c)
set(SKIPLATCH_injection inject/*.c)

# Headers that no user's header includes, and that say who alone uses them; by name, as an expression.
string(JOIN "|" SKIPLATCH_INTERNAL kinematics_problem kinematics_qr kinematics_coverage
  kinematics_slots kinematics_writes kinematics_requests transmission_gate)

set(SKIPLATCH_DIR ${CMAKE_CURRENT_LIST_DIR})
set(SKIPLATCH_INCLUDES ${SKIPLATCH_DIR} ${SKIPLATCH_DIR}/../hal/include)

# skiplatch_sources(VARIABLE PART...): the files of these parts.
function(skiplatch_sources variable)
  set(patterns)
  foreach(part IN LISTS ARGN)
    list(APPEND patterns ${SKIPLATCH_${part}})
  endforeach()
  list(TRANSFORM patterns PREPEND ${SKIPLATCH_DIR}/)
  file(GLOB files ${patterns})
  set(${variable} ${files} PARENT_SCOPE)
endfunction()

# skiplatch_configured(VARIABLE): the core, and the extensions that Kconfig has switched on.
function(skiplatch_configured variable)
  set(parts core)
  foreach(part IN LISTS SKIPLATCH_EXTENSIONS)
    string(TOUPPER ${part} upper)
    if(CONFIG_SKIPLATCH_${upper})
      list(APPEND parts ${part})
    endif()
  endforeach()
  set(${variable} ${parts} PARENT_SCOPE)
endfunction()
