"""The Arduino core of an Uno, as Debian packs it, with the flags of its own platform.txt."""

from SCons.Script import DefaultEnvironment

HARDWARE = "/usr/share/arduino/hardware/arduino/avr"
MACHINE = ["-mmcu=atmega328p"]

environment = DefaultEnvironment()
environment.Append(
    ASFLAGS=MACHINE,
    CCFLAGS=[*MACHINE, "-Os", "-ffunction-sections", "-fdata-sections"],
    CXXFLAGS=["-std=gnu++11", "-fno-exceptions", "-fno-threadsafe-statics"],
    LINKFLAGS=[*MACHINE, "-Os", "-Wl,--gc-sections"],
    CPPDEFINES=[
        ("F_CPU", "16000000L"),
        ("ARDUINO", 10808),
        "ARDUINO_AVR_UNO",
        "ARDUINO_ARCH_AVR",
        # The old compiler does not give C++ this name of C99, which the core wants.
        ("DECIMAL_DIG", "__DECIMAL_DIG__"),
    ],
    CPPPATH=[f"{HARDWARE}/cores/arduino", f"{HARDWARE}/variants/standard"],
    LIBS=["m"],
)
core = environment.BuildLibrary("$BUILD_DIR/FrameworkArduino", f"{HARDWARE}/cores/arduino")
environment.Prepend(LIBS=[core])
