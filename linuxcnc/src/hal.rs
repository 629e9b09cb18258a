//! LinuxCNC's HAL and real-time interface, as far as the component uses them (`hal.h`, `rtapi.h` of LinuxCNC 2.8 and 2.9).

use std::ffi::{CStr, CString, c_char, c_int, c_long, c_void};

unsafe extern "C" {
    fn hal_init(name: *const c_char) -> c_int;
    fn hal_exit(component: c_int) -> c_int;
    fn hal_ready(component: c_int) -> c_int;
    fn hal_malloc(bytes: c_long) -> *mut c_void;
    fn hal_pin_float_new(name: *const c_char, direction: c_int, at: *mut *mut f64, component: c_int) -> c_int;
    fn hal_pin_s32_new(name: *const c_char, direction: c_int, at: *mut *mut i32, component: c_int) -> c_int;
    fn hal_pin_u32_new(name: *const c_char, direction: c_int, at: *mut *mut u32, component: c_int) -> c_int;
    fn hal_pin_bit_new(name: *const c_char, direction: c_int, at: *mut *mut bool, component: c_int) -> c_int;
    fn hal_export_funct(
        name: *const c_char,
        function: unsafe extern "C" fn(*mut c_void, c_long),
        argument: *mut c_void,
        uses_floating_point: c_int,
        reentrant: c_int,
        component: c_int,
    ) -> c_int;
    fn rtapi_print_msg(level: c_int, format: *const c_char, ...);
}

/// `-EINVAL`.
pub(crate) const INVALID: c_int = -22;
/// `RTAPI_MSG_ERR`.
const MESSAGE_ERROR: c_int = 1;

/// Direction of a pin, as `hal_pin_dir_t`.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Direction {
    In = 16,
    Out = 32,
}

/// A function of the servo thread: its argument and the period in ns.
pub(crate) type Function = unsafe extern "C" fn(*mut c_void, c_long);

/// A value that a pin can have.
pub(crate) trait PinValue: Copy {
    const NEW: unsafe extern "C" fn(*const c_char, c_int, *mut *mut Self, c_int) -> c_int;
}

impl PinValue for f64 {
    const NEW: unsafe extern "C" fn(*const c_char, c_int, *mut *mut f64, c_int) -> c_int = hal_pin_float_new;
}

impl PinValue for i32 {
    const NEW: unsafe extern "C" fn(*const c_char, c_int, *mut *mut i32, c_int) -> c_int = hal_pin_s32_new;
}

impl PinValue for u32 {
    const NEW: unsafe extern "C" fn(*const c_char, c_int, *mut *mut u32, c_int) -> c_int = hal_pin_u32_new;
}

impl PinValue for bool {
    const NEW: unsafe extern "C" fn(*const c_char, c_int, *mut *mut bool, c_int) -> c_int = hal_pin_bit_new;
}

/// A pin. The HAL keeps, in its memory, the address of the value and changes it when the pin is connected.
pub(crate) struct Pin<T: PinValue>(*mut *mut T);

impl<T: PinValue> Pin<T> {
    pub(crate) fn get(&self) -> T {
        // SAFETY: `new` had the HAL set the address, and the HAL keeps it valid for as long as the component is loaded. Other
        // threads write the value, which is as wide as a register at most.
        unsafe { (*self.0).read_volatile() }
    }

    pub(crate) fn set(&self, value: T) {
        // SAFETY: as in `get`.
        unsafe { (*self.0).write_volatile(value) }
    }
}

/// The component, from `hal_init` to `hal_exit`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Component(c_int);

impl Component {
    /// Registers the component with the HAL, or returns the HAL's error.
    pub(crate) fn new(name: &CStr) -> Result<Self, c_int> {
        // SAFETY: the name ends with 0.
        let id = unsafe { hal_init(name.as_ptr()) };
        if id < 0 { Err(id) } else { Ok(Self(id)) }
    }

    /// Creates a pin with an initial value.
    pub(crate) fn pin<T: PinValue>(self, name: &str, direction: Direction, value: T) -> Result<Pin<T>, c_int> {
        let name = CString::new(name).map_err(|_| INVALID)?;
        // SAFETY: a plain allocation, which is checked; its memory stays until the HAL ends.
        let at = unsafe { hal_malloc(size_of::<*mut T>() as c_long) }.cast::<*mut T>();
        if at.is_null() {
            return Err(INVALID);
        }
        // SAFETY: `at` lies in the HAL's memory, as the function asks, and has the size of an address.
        let status = unsafe { (T::NEW)(name.as_ptr(), direction as c_int, at, self.0) };
        if status < 0 {
            return Err(status);
        }
        let pin = Pin(at);
        pin.set(value);
        Ok(pin)
    }

    /// Exports a function to the servo thread, with its argument, which must stay valid until [`Self::exit`].
    pub(crate) fn export(self, name: &CStr, function: Function, argument: *mut c_void) -> Result<(), c_int> {
        // SAFETY: the name ends with 0; the caller keeps the argument.
        let status = unsafe { hal_export_funct(name.as_ptr(), function, argument, 1, 0, self.0) };
        if status < 0 { Err(status) } else { Ok(()) }
    }

    /// Reports that all pins exist.
    pub(crate) fn ready(self) -> Result<(), c_int> {
        // SAFETY: the component exists.
        let status = unsafe { hal_ready(self.0) };
        if status < 0 { Err(status) } else { Ok(()) }
    }

    /// Ends the component; its functions are called no more.
    pub(crate) fn exit(self) {
        // SAFETY: the component exists.
        unsafe { hal_exit(self.0) };
    }
}

/// Writes an error into LinuxCNC's log.
pub(crate) fn report(message: &str) {
    let line = CString::new(format!("posicast_shaper: {message}\n").replace('\0', " "));
    if let Ok(line) = line {
        // SAFETY: the format takes one text that ends with 0.
        unsafe { rtapi_print_msg(MESSAGE_ERROR, c"%s".as_ptr(), line.as_ptr()) };
    }
}
