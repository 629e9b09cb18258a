-- An instance of xy_stage, to copy into a design
-- Written by posicast 0.1.0; do not edit.

library ieee;
use ieee.std_logic_1164.all;
use work.xy_stage_pkg.all;

entity xy_stage_instance is
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
end entity;

architecture template of xy_stage_instance is
begin
    u_xy_stage : xy_stage
        port map (
            clk                  => clk,
            rst                  => rst,
            strobe               => strobe,
            x_start              => x_start,
            x_x                  => x_x,
            x_clear_flags        => x_clear_flags,
            x_tap_write          => x_tap_write,
            x_tap_bank           => x_tap_bank,
            x_tap_index          => x_tap_index,
            x_tap_coefficient    => x_tap_coefficient,
            x_tap_delay          => x_tap_delay,
            x_tap_read           => x_tap_read,
            x_swap               => x_swap,
            x_swap_bank          => x_swap_bank,
            x_y                  => x_y,
            x_valid              => x_valid,
            x_saturated          => x_saturated,
            x_busy               => x_busy,
            x_overrun            => x_overrun,
            x_swap_pending       => x_swap_pending,
            x_bank               => x_bank,
            x_refused            => x_refused,
            x_loaded_coefficient => x_loaded_coefficient,
            x_loaded_delay       => x_loaded_delay,
            x_tap_read_waits     => x_tap_read_waits,
            y_start              => y_start,
            y_x                  => y_x,
            y_clear_flags        => y_clear_flags,
            y_tap_write          => y_tap_write,
            y_tap_bank           => y_tap_bank,
            y_tap_index          => y_tap_index,
            y_tap_coefficient    => y_tap_coefficient,
            y_tap_delay          => y_tap_delay,
            y_tap_read           => y_tap_read,
            y_swap               => y_swap,
            y_swap_bank          => y_swap_bank,
            y_y                  => y_y,
            y_valid              => y_valid,
            y_saturated          => y_saturated,
            y_busy               => y_busy,
            y_overrun            => y_overrun,
            y_swap_pending       => y_swap_pending,
            y_bank               => y_bank,
            y_refused            => y_refused,
            y_loaded_coefficient => y_loaded_coefficient,
            y_loaded_delay       => y_loaded_delay,
            y_tap_read_waits     => y_tap_read_waits
        );
end architecture;
