-- xy_stage: component declaration and constants for a design in VHDL
-- Written by posicast 0.1.0; do not edit.

library ieee;
use ieee.std_logic_1164.all;

package xy_stage_pkg is

    component xy_stage is
        port (
            clk                  : in  std_logic;
            rst                  : in  std_logic;
            strobe               : in  std_logic;
            x_start              : in  std_logic;
            x_x                  : in  std_logic_vector(31 downto 0);  -- signed
            x_clear_flags        : in  std_logic;
            x_tap_write          : in  std_logic;
            x_tap_bank           : in  std_logic_vector(1 downto 0);
            x_tap_index          : in  std_logic_vector(5 downto 0);
            x_tap_coefficient    : in  std_logic_vector(17 downto 0);  -- signed
            x_tap_delay          : in  std_logic_vector(6 downto 0);
            x_tap_read           : in  std_logic;
            x_swap               : in  std_logic;
            x_swap_bank          : in  std_logic_vector(1 downto 0);
            x_y                  : out std_logic_vector(31 downto 0);  -- signed
            x_valid              : out std_logic;
            x_saturated          : out std_logic;
            x_busy               : out std_logic;
            x_overrun            : out std_logic;
            x_swap_pending       : out std_logic;
            x_bank               : out std_logic_vector(1 downto 0);
            x_refused            : out std_logic;
            x_loaded_coefficient : out std_logic_vector(17 downto 0);  -- signed
            x_loaded_delay       : out std_logic_vector(6 downto 0);
            x_tap_read_waits     : out std_logic;
            y_start              : in  std_logic;
            y_x                  : in  std_logic_vector(31 downto 0);  -- signed
            y_clear_flags        : in  std_logic;
            y_tap_write          : in  std_logic;
            y_tap_bank           : in  std_logic_vector(1 downto 0);
            y_tap_index          : in  std_logic_vector(5 downto 0);
            y_tap_coefficient    : in  std_logic_vector(17 downto 0);  -- signed
            y_tap_delay          : in  std_logic_vector(6 downto 0);
            y_tap_read           : in  std_logic;
            y_swap               : in  std_logic;
            y_swap_bank          : in  std_logic_vector(1 downto 0);
            y_y                  : out std_logic_vector(31 downto 0);  -- signed
            y_valid              : out std_logic;
            y_saturated          : out std_logic;
            y_busy               : out std_logic;
            y_overrun            : out std_logic;
            y_swap_pending       : out std_logic;
            y_bank               : out std_logic_vector(1 downto 0);
            y_refused            : out std_logic;
            y_loaded_coefficient : out std_logic_vector(17 downto 0);  -- signed
            y_loaded_delay       : out std_logic_vector(6 downto 0);
            y_tap_read_waits     : out std_logic
        );
    end component;

    -- Delay in samples and coefficient of each tap.
    type tap_t is array (0 to 1) of integer;
    type taps_t is array (natural range <>) of tap_t;
    -- They sum to 65536.
    constant x_taps : taps_t := (
        0 => (0, 25420),
        1 => (38, 11870),
        2 => (39, 18927),
        3 => (77, 7146),
        4 => (78, 2173)
    );
    -- They sum to 65536.
    constant y_taps : taps_t := (
        0 => (0, 25160),
        1 => (54, 23540),
        2 => (55, 7354),
        3 => (108, 4959),
        4 => (109, 4523)
    );

end package;
