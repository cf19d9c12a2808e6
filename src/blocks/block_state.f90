!> The state: the motion of all unknowns at one instant, with the drives and the findings of the solver there.
module block_state
   use kinds, only: wp
   use number_types, only: vector_t, unknown_t, loop_state_t
   use plane_vectors, only: wrap_angle
   use drive_path, only: drive_path_t, drive_at
   use blocks, only: blocks_t, geometry_t, loop_angles
   implicit none
   private
   public :: unknown_t, loop_state_t, jacobian_t, state_t, new_state, set_drive_values, set_direction, set_values, &
      values_of, given, add_turns, largest_drive_rate

   !> Findings from the factors of a block's Jacobian J.
   type :: jacobian_t
      integer :: sign_of = 1                         !< sign of the determinant; 1 of an explicit block; 0: exactly 0
      real(wp) :: pivot = 1.0_wp                     !< the least |pivot|; 1 of an explicit block
      !> |J^-1| in the maximum norm, or 1/pivot for it where that is small enough; 0 of an explicit block.
      real(wp) :: inverse = 0.0_wp
   end type jacobian_t

   !> The motion found last: only values, no factors, no scratch. A checkpoint is an assignment.
   type :: state_t
      real(wp) :: t = 0.0_wp                         !< the parameter of its path, in the deck's unit of time
      real(wp) :: change = 0.0_wp                    !< the largest change of a predicted value, rad or unit of its loop
      type(unknown_t), allocatable :: u(:)           !< (0:unknowns); 0 is the ground's angle
      type(loop_state_t), allocatable :: loop(:)     !< (loops) by the last assembly of each
      type(vector_t), allocatable :: own(:)          !< (body vectors) R d, if an angle of its own block rotates it
      type(vector_t), allocatable :: guide(:)        !< (slides) R e, their directions in the fixed axes
      real(wp), allocatable :: drive_value(:, :)     !< (0:2, 0:drives) value, rate and acceleration of each drive
      real(wp) :: excursion = 0.0_wp                 !< of the drives off their chords (rad, characteristic lengths)
      type(jacobian_t), allocatable :: jacobian(:)   !< (blocks)
      logical, allocatable :: is_singular(:)         !< (blocks) its Jacobian has no inverse: it has no unique rates
      logical, allocatable :: crossed(:)             !< (blocks) the sign of the determinant has changed
   end type state_t

contains

   !> Makes a state: all unknowns and drives 0, no block singular.
   pure function new_state(b, drives) result(s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: drives                  !< how many drives there are
      type(state_t) :: s

      allocate (s%u(0:b%unknowns), s%loop(size(b%loops)), s%own(size(b%body_vectors)), s%guide(size(b%slides)))
      allocate (s%drive_value(0:2, 0:drives), source=0.0_wp)
      allocate (s%jacobian(size(b%list)))
      allocate (s%crossed(size(b%list)), s%is_singular(size(b%list)), source=.false.)
   end function new_state

   !> Puts the state at a parameter of the path of its drives, with value, rate and acceleration of each drive.
   pure subroutine set_drive_values(path, t, s)
      type(drive_path_t), intent(in) :: path   !< of the drives
      real(wp), intent(in) :: t                      !< the parameter, in the deck's unit of time
      type(state_t), intent(inout) :: s              !< t and drive_value are set
      real(wp) :: f(3)
      integer :: i

      s%t = t
      do i = 1, size(path%laws)
         f = drive_at(path, i, t)
         s%drive_value(0:2, i) = path%unit(i)*f
      end do
   end subroutine set_drive_values

   !> Finds cosine and sine of an unknown from its value, if it is an angle; otherwise nothing changes.
   pure subroutine set_direction(b, unknown, s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: unknown                 !< the number of the unknown
      type(state_t), intent(inout) :: s              !< with the value of the unknown

      if (unknown > b%orientations) return
      s%u(unknown)%c = cos(s%u(unknown)%value)
      s%u(unknown)%s = sin(s%u(unknown)%value)
   end subroutine set_direction

   !> Gives the unknowns of a block values, and its angles cosine and sine. Rates stay.
   pure subroutine set_values(b, i, values, s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i                       !< the number of the block
      real(wp), intent(in) :: values(:)              !< (unknowns of the block) rad or unit of the loop
      type(state_t), intent(inout) :: s
      integer :: k

      do k = 1, size(values)
         s%u(b%unknown(b%list(i)%first + k - 1))%value = values(k)
         call set_direction(b, b%unknown(b%list(i)%first + k - 1), s)
      end do
   end subroutine set_values

   !> Gives the values (unknowns of the block) of the unknowns of a block, in rad or the units of their loops.
   pure function values_of(b, i, s) result(x)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i                       !< the number of the block
      type(state_t), intent(in) :: s
      real(wp) :: x(b%list(i)%last - b%list(i)%first + 1)

      x = s%u(b%unknown(b%list(i)%first:b%list(i)%last))%value
   end function values_of

   !> Gives the value that a row of a block requires, the sum of its constant and the value of its drive, in rad or the
   !> unit of the loop.
   pure real(wp) function given(b, x, i, row, s)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i                       !< the number of the block
      integer, intent(in) :: row                     !< the number of the row in the block
      type(state_t), intent(in) :: s                 !< with the drives

      associate (k => b%list(i)%first_row + row - 1)
         given = x%rows(k)%constant + s%drive_value(0, b%rows(k)%drive)
      end associate
   end function given

   !> Adds whole turns to the angles of a block, so that each of its equations of one or two angles holds to half a
   !> turn. Angles that such equations join turn together; if they form a circle, one of these equations is left out.
   pure subroutine add_turns(b, x, i, s)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i                       !< the number of the block
      type(state_t), intent(inout) :: s              !< with the drives; the angles of the block are changed
      real(wp) :: turns(0:b%list(i)%shape%n), off
      integer :: group(0:b%list(i)%shape%n), joins, to, m, k

      ! By column: earlier blocks give the angles of column 0, and group 0 holds all angles that are joined to these.
      turns = 0.0_wp
      group = [(k, k=0, b%list(i)%shape%n)]
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m))
            if (g%kind /= loop_angles .or. g%orientation > b%orientations) cycle
            off = given(b, x, i, g%row_x, s) - s%u(g%orientation)%value - turns(g%orientation_column) &
               + s%u(g%less)%value + turns(g%less_column)
            joins = group(g%orientation_column)
            to = group(g%less_column)
         end associate

         if (joins == 0) then
            off = -off
            joins = to
            to = 0
         end if
         if (joins == to) cycle
         where (group == joins)
            turns = turns + (off - wrap_angle(off))
            group = to
         end where
      end do
      call set_values(b, i, values_of(b, i, s) + turns(1:), s)
   end subroutine add_turns

   !> Gives the largest |rate| of a drive, in rad or its loop's unit of length by time; 0 without drives.
   pure real(wp) function largest_drive_rate(s) result(rate)
      type(state_t), intent(in) :: s                 !< with the drives

      rate = maxval(abs(s%drive_value(1, :)))
   end function largest_drive_rate
end module block_state
