-- xy_stage_y_sliding_mode_avalon: component declaration and constants for a design in VHDL
-- Written by posicast 0.1.0; do not edit.

library ieee;
use ieee.std_logic_1164.all;

package xy_stage_y_sliding_mode_avalon_pkg is

    component xy_stage_y_sliding_mode_avalon is
        port (
            clk                    : in  std_logic;
            rst                    : in  std_logic;
            avs_address            : in  std_logic_vector(7 downto 0);
            avs_read               : in  std_logic;
            avs_write              : in  std_logic;
            avs_byteenable         : in  std_logic_vector(3 downto 0);
            avs_writedata          : in  std_logic_vector(31 downto 0);
            start                  : in  std_logic;
            position_reference     : in  std_logic_vector(31 downto 0);  -- signed
            velocity_reference     : in  std_logic_vector(31 downto 0);  -- signed
            acceleration_reference : in  std_logic_vector(31 downto 0);  -- signed
            position               : in  std_logic_vector(31 downto 0);  -- signed
            velocity               : in  std_logic_vector(31 downto 0);  -- signed
            avs_readdata           : out std_logic_vector(31 downto 0);
            irq                    : out std_logic;
            command                : out std_logic_vector(31 downto 0);  -- signed
            duty                   : out std_logic_vector(17 downto 0);  -- signed
            valid                  : out std_logic
        );
    end component;

    -- Word addresses of the registers.
    constant magic_word                  : natural := 16#0#;
    constant version_word                : natural := 16#1#;
    constant snapshot_word               : natural := 16#8#;
    constant commit_word                 : natural := 16#9#;
    constant control_word                : natural := 16#10#;
    constant law_word                    : natural := 16#11#;
    constant status_word                 : natural := 16#12#;
    constant flags_word                  : natural := 16#13#;
    constant interrupt_state_word        : natural := 16#14#;
    constant interrupt_enable_word       : natural := 16#15#;
    constant interrupt_test_word         : natural := 16#16#;
    constant position_reference_word     : natural := 16#18#;
    constant velocity_reference_word     : natural := 16#19#;
    constant acceleration_reference_word : natural := 16#1a#;
    constant position_word               : natural := 16#1b#;
    constant velocity_word               : natural := 16#1c#;
    constant start_word                  : natural := 16#1d#;
    constant clear_integral_word         : natural := 16#1e#;
    constant clear_flags_word            : natural := 16#1f#;
    constant error_word                  : natural := 16#20#;
    constant sliding_word                : natural := 16#21#;
    constant command_word                : natural := 16#22#;
    constant duty_word                   : natural := 16#23#;
    constant limited_ticks_word          : natural := 16#24#;
    constant setting_address_word        : natural := 16#28#;
    constant setting_word                : natural := 16#29#;
    constant setting_read_word           : natural := 16#2a#;
    constant setting_loaded_word         : natural := 16#2b#;
    constant snapshot_error_word         : natural := 16#30#;
    constant snapshot_sliding_word       : natural := 16#31#;
    constant snapshot_command_word       : natural := 16#32#;
    constant snapshot_duty_word          : natural := 16#33#;

end package;
