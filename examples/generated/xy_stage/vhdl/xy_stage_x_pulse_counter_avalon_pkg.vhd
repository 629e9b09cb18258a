-- xy_stage_x_pulse_counter_avalon: component declaration and constants for a design in VHDL
-- Written by posicast 0.1.0; do not edit.

library ieee;
use ieee.std_logic_1164.all;

package xy_stage_x_pulse_counter_avalon_pkg is

    component xy_stage_x_pulse_counter_avalon is
        port (
            clk            : in  std_logic;
            rst            : in  std_logic;
            avs_address    : in  std_logic_vector(7 downto 0);
            avs_read       : in  std_logic;
            avs_write      : in  std_logic;
            avs_byteenable : in  std_logic_vector(3 downto 0);
            avs_writedata  : in  std_logic_vector(31 downto 0);
            a              : in  std_logic;
            b              : in  std_logic;
            z              : in  std_logic;
            a_n            : in  std_logic;
            b_n            : in  std_logic;
            z_n            : in  std_logic;
            avs_readdata   : out std_logic_vector(31 downto 0);
            irq            : out std_logic;
            tick           : out std_logic;
            position       : out std_logic_vector(31 downto 0);  -- signed
            velocity       : out std_logic_vector(31 downto 0);  -- signed
            velocity_valid : out std_logic
        );
    end component;

    -- Word addresses of the registers.
    constant magic_word                : natural := 16#0#;
    constant version_word              : natural := 16#1#;
    constant tick_clocks_word          : natural := 16#2#;
    constant snapshot_word             : natural := 16#8#;
    constant lines_word                : natural := 16#10#;
    constant index_word                : natural := 16#11#;
    constant velocity_filter_word      : natural := 16#12#;
    constant preset_value_word         : natural := 16#13#;
    constant interrupt_state_word      : natural := 16#14#;
    constant interrupt_enable_word     : natural := 16#15#;
    constant interrupt_test_word       : natural := 16#16#;
    constant preset_word               : natural := 16#18#;
    constant index_arm_word            : natural := 16#19#;
    constant clear_flags_word          : natural := 16#1a#;
    constant flags_word                : natural := 16#1b#;
    constant status_word               : natural := 16#1c#;
    constant position_word             : natural := 16#20#;
    constant velocity_word             : natural := 16#21#;
    constant time_stamp_word           : natural := 16#22#;
    constant tick_count_word           : natural := 16#23#;
    constant count_word                : natural := 16#24#;
    constant index_count_word          : natural := 16#25#;
    constant origin_word               : natural := 16#26#;
    constant snapshot_position_word    : natural := 16#30#;
    constant snapshot_velocity_word    : natural := 16#31#;
    constant snapshot_time_stamp_word  : natural := 16#32#;
    constant snapshot_tick_count_word  : natural := 16#33#;
    constant snapshot_count_word       : natural := 16#34#;
    constant snapshot_index_count_word : natural := 16#35#;

end package;
