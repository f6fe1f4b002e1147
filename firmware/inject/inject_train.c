#include "inject/inject_train.h"

void inject_train_begin(inject_train_t *train, const inject_shot_t *shot, uint32_t now_us)
{
    *train = (inject_train_t){.shot = *shot, .remaining = shot->count};
    train->lead_us = now_us + shot->delay_us;
    train->due_us = train->lead_us;
}

bool inject_train_is_playing(const inject_train_t *train)
{
    return train->remaining != 0u;
}

uint32_t inject_train_wait_us(const inject_train_t *train, uint32_t now_us)
{
    uint32_t ahead_us = train->due_us - now_us;
    return ahead_us <= UINT32_MAX / 2u ? ahead_us : 0u;
}

bool inject_train_is_leading(const inject_train_t *train)
{
    return !train->is_driven;
}

uint8_t inject_train_level(const inject_train_t *train)
{
    return (uint8_t)(inject_train_is_leading(train) ? train->shot.level : train->shot.level ^ 1u);
}

void inject_train_advance(inject_train_t *train, uint32_t driven_us)
{
    if (inject_train_is_leading(train)) {
        train->is_driven = true;
        train->due_us = driven_us + train->shot.width_us;
        return;
    }
    train->is_driven = false;
    --train->remaining;
    train->lead_us += train->shot.period_us;
    train->due_us = train->lead_us;
}
