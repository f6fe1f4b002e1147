/* Error codes of the porting surface: 0 is success, a negative code says why not. */
#ifndef HAL_ERROR_H
#define HAL_ERROR_H

#define HAL_OK          0
#define HAL_ERR_CHANNEL (-1) /* the board has no such channel or axis */
#define HAL_ERR_CONFIG  (-2) /* the board cannot do what the configuration asks for */
#define HAL_ERR_BUSY    (-3) /* not now; try again from the task */

#endif
