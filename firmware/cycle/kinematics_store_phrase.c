#include "cycle/kinematics_store.h"

const char *kinematics_store_phrase(kinematics_store_error_t error)
{
    static const char *const PHRASES[] = {
        [KINEMATICS_STORE_OK] = "no error",
        [KINEMATICS_STORE_ERR_MODE] = "Q410 MODE is not 0, 1, 2 or 3",
        [KINEMATICS_STORE_ERR_DESIGNATION] =
            "Q409 MEMORY DESIGNATION is no number from 0 to 99999 and no name of 16 characters",
        [KINEMATICS_STORE_ERR_NOT_FOUND] = "nothing is saved under Q409 MEMORY DESIGNATION",
        [KINEMATICS_STORE_ERR_FULL] = "all 16 places are taken",
        [KINEMATICS_STORE_ERR_NO_ACTIVE] = "there are no active kinematics to save",
        [KINEMATICS_STORE_ERR_LENGTH] = "the description is empty or too long",
        [KINEMATICS_STORE_ERR_BUSY] = "the operation before is not over",
        [KINEMATICS_STORE_ERR_DAMAGED] = "the memory has lost bits; what it holds is in doubt",
        [KINEMATICS_STORE_ERR_FOREIGN] = "what stands in the memory is not from this store",
    };
    return PHRASES[error];
}
