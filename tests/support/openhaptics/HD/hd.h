#pragma once

/* A stand-in for the header of 3D Systems' OpenHaptics: names, types and meaning of the few HD functions that
 * examples/touch calls, by their public documentation (OpenHaptics API Reference Guide, chapters 2 to 6). The
 * numbers are the stand-in's own. What they do is in openhaptics_stand_in.cpp. */

#ifdef __cplusplus
extern "C" {
#endif

typedef unsigned int HHD;
typedef unsigned int HDenum;
typedef unsigned int HDerror;
typedef unsigned int HDCallbackCode;
typedef unsigned long HDSchedulerHandle;
typedef int HDint;
typedef unsigned short HDushort;
typedef double HDdouble;
typedef const char* HDstring;

typedef struct {
  HDerror errorCode;
  int internalErrorCode;
  HHD hHD;
} HDErrorInfo;

#define HDCALLBACK
typedef HDCallbackCode(HDCALLBACK* HDSchedulerCallback)(void* pUserData);

#define HD_DEFAULT_DEVICE ((HDstring)0)
#define HD_INVALID_HANDLE 0xFFFFFFFFu
#define HD_CALLBACK_DONE 0u
#define HD_CALLBACK_CONTINUE 1u
#define HD_MAX_SCHEDULER_PRIORITY 100
#define HD_DEFAULT_SCHEDULER_PRIORITY 50

#define HD_DEVICE_BUTTON_1 0x1
#define HD_DEVICE_BUTTON_2 0x2
#define HD_DEVICE_BUTTON_3 0x4
#define HD_DEVICE_BUTTON_4 0x8

#define HD_FORCE_OUTPUT 11u
#define HD_CURRENT_TRANSFORM 21u
#define HD_CURRENT_BUTTONS 22u
#define HD_CURRENT_FORCE 23u
#define HD_NOMINAL_MAX_FORCE 31u
#define HD_NOMINAL_MAX_STIFFNESS 32u
#define HD_USABLE_WORKSPACE_DIMENSIONS 33u
#define HD_DEVICE_MODEL_TYPE 34u
#define HD_CALIBRATION_STYLE 35u

#define HD_CALIBRATION_ENCODER_RESET 0x1u
#define HD_CALIBRATION_AUTO 0x2u
#define HD_CALIBRATION_INKWELL 0x4u
#define HD_CALIBRATION_OK 41u
#define HD_CALIBRATION_NEEDS_UPDATE 42u
#define HD_CALIBRATION_NEEDS_MANUAL_INPUT 43u

#define HD_SUCCESS 0u
#define HD_INVALID_OPERATION 102u
#define HD_BAD_HANDLE 104u
#define HD_WARM_MOTORS 201u
#define HD_EXCEEDED_MAX_FORCE 202u
#define HD_EXCEEDED_MAX_FORCE_IMPULSE 203u
#define HD_EXCEEDED_MAX_VELOCITY 204u
#define HD_FORCE_ERROR 205u
#define HD_DEVICE_FAULT 301u
#define HD_DEVICE_ALREADY_INITIATED 302u
#define HD_COMM_ERROR 303u
#define HD_COMM_CONFIG_ERROR 304u
#define HD_TIMER_ERROR 305u

HHD hdInitDevice(HDstring pConfigName);
void hdDisableDevice(HHD hHD);
void hdMakeCurrentDevice(HHD hHD);
void hdBeginFrame(HHD hHD);
void hdEndFrame(HHD hHD);
void hdEnable(HDenum cap);
void hdGetDoublev(HDenum pname, HDdouble* params);
void hdGetIntegerv(HDenum pname, HDint* params);
void hdSetDoublev(HDenum pname, const HDdouble* params);
HDstring hdGetString(HDenum pname);
HDErrorInfo hdGetError(void);
HDstring hdGetErrorString(HDerror errorCode);
HDenum hdCheckCalibration(void);
void hdUpdateCalibration(HDenum style);
void hdStartScheduler(void);
void hdStopScheduler(void);
HDSchedulerHandle hdScheduleAsynchronous(HDSchedulerCallback pCallback, void* pUserData, HDushort nPriority);
void hdScheduleSynchronous(HDSchedulerCallback pCallback, void* pUserData, HDushort nPriority);
void hdUnschedule(HDSchedulerHandle hHandle);

#ifdef __cplusplus
}
#endif
