#include <string.h>

#include "cycle/kinematics_slots.h"
#include "cycle/kinematics_store.h"

kinematics_store_error_t kinematics_store_number(kinematics_designation_t *designation,
                                                 double                    number)
{
    bool is_sound = number >= 0.0 && number <= KINEMATICS_STORE_NUMBER_MAX;
    if (!is_sound || number - (double)(uint32_t)number > 0.0) {
        return KINEMATICS_STORE_ERR_DESIGNATION;
    }
    memset(designation, 0, sizeof *designation);
    designation->bytes[0] = IS_NUMBER;
    kinematics_slot_put(designation->bytes + 1, 4u, (uint32_t)number);
    return KINEMATICS_STORE_OK;
}

kinematics_store_error_t kinematics_store_name(kinematics_designation_t *designation,
                                               const char               *name)
{
    uint8_t length = 0u;

    while (length <= KINEMATICS_STORE_NAME_MAX && name[length] != '\0') {
        if (name[length] < ' ' || name[length] > '~') {
            return KINEMATICS_STORE_ERR_DESIGNATION;
        }
        length++;
    }
    if (length == 0u || length > KINEMATICS_STORE_NAME_MAX || name[0] == ' ' ||
        name[length - 1u] == ' ') {
        return KINEMATICS_STORE_ERR_DESIGNATION;
    }
    memset(designation, 0, sizeof *designation);
    designation->bytes[0] = IS_NAME;
    memcpy(designation->bytes + 1, name, length);
    return KINEMATICS_STORE_OK;
}

static void write_number(uint32_t number, char *text)
{
    uint8_t length = 1u;
    for (uint32_t rest = number; rest > 9u; rest /= 10u) {
        length++;
    }
    text[length] = '\0';
    while (length-- > 0u) {
        text[length] = (char)('0' + number % 10u);
        number /= 10u;
    }
}

void kinematics_store_text(const kinematics_designation_t *designation, char *text)
{
    if (designation->bytes[0] == IS_NUMBER) {
        write_number(kinematics_slot_get(designation->bytes + 1, 4u), text);
    } else {
        memcpy(text, designation->bytes + 1, KINEMATICS_STORE_NAME_MAX);
        text[KINEMATICS_STORE_NAME_MAX] = '\0';
    }
}

static bool is_blank(const uint8_t *bytes, uint8_t begin)
{
    while (begin <= KINEMATICS_STORE_NAME_MAX && bytes[begin] == 0u) {
        begin++;
    }
    return begin > KINEMATICS_STORE_NAME_MAX;
}

static bool is_name(const uint8_t *bytes)
{
    uint8_t end = 1u;
    while (end <= KINEMATICS_STORE_NAME_MAX && bytes[end] >= ' ' && bytes[end] <= '~') {
        end++;
    }
    return end > 1u && bytes[1] != ' ' && bytes[end - 1u] != ' ' && is_blank(bytes, end);
}

bool kinematics_designation_is_own(const kinematics_designation_t *designation)
{
    const uint8_t *bytes = designation->bytes;
    switch (bytes[0]) {
    case IS_ACTIVE:
        return is_blank(bytes, 1u);
    case IS_NUMBER:
        return kinematics_slot_get(bytes + 1, 4u) <= KINEMATICS_STORE_NUMBER_MAX &&
               is_blank(bytes, 5u);
    case IS_NAME:
        return is_name(bytes);
    default:
        return false;
    }
}
