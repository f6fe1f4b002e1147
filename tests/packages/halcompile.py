"""What halcompile makes of a component, as far as a compiler needs it: no LinuxCNC has to be here.

Pins, parameters and variables are macros for members of one structure, as halcompile has them, and
stand behind what the component includes.
"""

import re

TYPES = {"bit": "bool", "float": "double", "s32": "int32_t", "u32": "uint32_t"}

_PIN = re.compile(r"^(?:pin|param) (in|out|io|r|rw) (\w+) (\w+)", re.MULTILINE)
_VARIABLE = re.compile(r"^variable ([\w ]+?) (\w+)(\[\d+\])?(?: = .*)?;", re.MULTILINE)
_INCLUDE = re.compile(r"^include (.+);", re.MULTILINE)

HEAD = """\
#include <stdbool.h>
#include <stdint.h>
#include <math.h>
typedef int64_t rtapi_s64;
rtapi_s64 rtapi_get_time(void);
static int comp_id;
"""
STATE = """\
struct __comp_state {{
{members}
}};
static int default_count = 1, count;
int rtapi_app_main(void);
int rtapi_app_main(void) {{ return comp_id + default_count + count; }}
#define FUNCTION(name) \\
    void name(struct __comp_state *__comp_inst, long period); \\
    void name(struct __comp_state *__comp_inst, long period)
"""


def as_c(component: str) -> str:
    """Give the C file of a component's text."""
    declared, _, body = component.partition("\n;;\n")
    members = []
    macros = []
    for way, kind, name in _PIN.findall(declared):
        members.append(f"    {TYPES[kind]} {name};")
        # What comes in cannot be assigned.
        macros.append(f"#define {name} ({'0 + ' if way == 'in' else ''}__comp_inst->{name})")
    for kind, name, size in _VARIABLE.findall(declared):
        members.append(f"    {kind} {name}{size};")
        macros.append(f"#define {name} (__comp_inst->{name})")
    included = "".join(f"#include {name}\n" for name in _INCLUDE.findall(declared))
    state = STATE.format(members="\n".join(members))
    body = re.sub(r"^#include <rtapi_\w+\.h>$", "", body, flags=re.MULTILINE)
    return f"{HEAD}{included}{state}" + "\n".join(macros) + body
