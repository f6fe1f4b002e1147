"""Which compiler builds the program; PlatformIO has told SCons of its sources and libraries."""

from SCons.Script import DefaultEnvironment

environment = DefaultEnvironment()
environment.Replace(
    AR="avr-gcc-ar",
    AS="avr-as",
    CC="avr-gcc",
    CXX="avr-g++",
    LINK="avr-gcc",
    RANLIB="avr-gcc-ranlib",
    PROGSUFFIX=".elf",
    SIZETOOL=None,
)
environment.Default(environment.BuildProgram())
