-- xy_stage_y_pwm_avalon: component declaration and constants for a design in VHDL
-- Written by posicast 0.1.0; do not edit.

library ieee;
use ieee.std_logic_1164.all;

package xy_stage_y_pwm_avalon_pkg is

    component xy_stage_y_pwm_avalon is
        port (
            clk              : in  std_logic;
            rst              : in  std_logic;
            avs_address      : in  std_logic_vector(7 downto 0);
            avs_read         : in  std_logic;
            avs_write        : in  std_logic;
            avs_byteenable   : in  std_logic_vector(3 downto 0);
            avs_writedata    : in  std_logic_vector(31 downto 0);
            feed             : in  std_logic;
            duty             : in  std_logic_vector(16 downto 0);  -- signed
            sync             : in  std_logic;
            fault_n          : in  std_logic;
            pll_locked       : in  std_logic;
            filtered_fault_n : in  std_logic_vector(1 downto 0);
            avs_readdata     : out std_logic_vector(31 downto 0);
            irq              : out std_logic;
            a_high           : out std_logic;
            a_low            : out std_logic;
            b_high           : out std_logic;
            b_low            : out std_logic;
            running          : out std_logic;
            tripped          : out std_logic;
            valley           : out std_logic;
            peak             : out std_logic;
            trigger          : out std_logic
        );
    end component;

    -- Word addresses of the registers.
    constant magic_word               : natural := 16#0#;
    constant version_word             : natural := 16#1#;
    constant dead_time_floor_word     : natural := 16#2#;
    constant minimum_pulse_floor_word : natural := 16#3#;
    constant control_word             : natural := 16#10#;
    constant status_word              : natural := 16#11#;
    constant flags_word               : natural := 16#12#;
    constant interrupt_state_word     : natural := 16#14#;
    constant interrupt_enable_word    : natural := 16#15#;
    constant interrupt_test_word      : natural := 16#16#;
    constant period_word              : natural := 16#18#;
    constant times_word               : natural := 16#19#;
    constant duty_word                : natural := 16#1a#;
    constant max_duty_word            : natural := 16#1b#;
    constant phase_word               : natural := 16#1c#;
    constant supervision_word         : natural := 16#1d#;
    constant feed_word                : natural := 16#1e#;
    constant clear_trip_word          : natural := 16#1f#;
    constant times_used_word          : natural := 16#20#;

end package;
