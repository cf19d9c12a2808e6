!> The drawing of a set for CAD: entities of DXF (Release 12) in the deck's unit of length, y up. Layer PATHS has the
!> paths of points through the instants of the deck; JOINTS and LINKS have the first instant.
module dxf
   use kinds, only: wp
   use mechanism, only: mechanism_t, has_path, has_guide, is_fixed
   use motion, only: motion_t
   use points, only: row_t
   use plane_vectors, only: direction
   use scales, only: characteristic_length
   use separations, only: closes
   use set_motion, only: set_motion_t, find_row_in_set, apart_from
   use drawing, only: drawing_t, point_place, moved
   use number_format, only: whole, rounded
   use text_output, only: output_t, put
   implicit none
   private
   public :: point_path_t, new_paths, extend_paths, begin_dxf, write_dxf, end_dxf

   !> The path of a point.
   type :: point_path_t
      integer :: request = 0                 !< the row of the point, among the requests of the set
      real(wp), allocatable :: places(:, :)  !< (2, instants) in the deck's coordinates
      logical, allocatable :: known(:)       !< (instants)
      type(motion_t), allocatable :: first(:)   !< (parts) the motions at the first instant; only in the first path
      logical :: is_closed = .false.         !< the motion of the set closes; only in the first path
   end type point_path_t

   !> Significant digits of a number.
   integer, parameter :: significant_digits = 12
   !> The radius of the circle of a joint, in characteristic lengths.
   real(wp), parameter :: circle_radius = 0.015_wp

contains

   !> Begins the paths of the points that PRINT cards ask for, without those of the ground.
   subroutine new_paths(m, paths)
      type(mechanism_t), intent(in) :: m     !< the set
      type(point_path_t), allocatable, intent(out) :: paths(:)   !< (any number)
      integer :: i, instants
      integer, allocatable :: list(:)

      instants = m%steps + 1
      if (m%steps < 0) instants = size(m%at)
      list = pack([(i, i=1, size(m%requests))], has_path(m%requests) .and. &
         .not. [(is_fixed(m, m%requests(i)), i=1, size(m%requests))])
      allocate (paths(size(list)))
      do i = 1, size(list)
         paths(i)%request = list(i)
         allocate (paths(i)%places(2, instants), paths(i)%known(instants))
      end do
   end subroutine new_paths

   !> Adds an instant to paths. After the last instant of the deck `is_closed` is known.
   subroutine extend_paths(paths, motions, k)
      type(point_path_t), intent(inout) :: paths(:)   !< (any number) of the set, as `new_paths` has made them
      type(set_motion_t), intent(in) :: motions   !< at the instant
      integer, intent(in) :: k               !< number of the instant, from 0
      type(row_t) :: row
      real(wp) :: apart(3)
      integer :: i

      do i = 1, size(paths)
         call find_row_in_set(motions, paths(i)%request, row)
         paths(i)%places(:, k + 1) = row%value(:2, 0)
         paths(i)%known(k + 1) = row%known >= 0
      end do
      if (size(paths) == 0) return
      associate (one => paths(1))
         if (k == 0) one%first = motions%motions
         if (k == 0 .or. k + 1 < size(one%known)) return
         one%is_closed = all(one%known)
         do i = 1, motions%count
            apart = apart_from(motions, i, one%first(i))
            one%is_closed = one%is_closed .and. closes(apart(:2))
         end do
      end associate
   end subroutine extend_paths

   !> Begins a file: the section ENTITIES.
   subroutine begin_dxf(o)
      type(output_t), intent(inout) :: o

      call write_pair(o, 0, 'SECTION')
      call write_pair(o, 2, 'ENTITIES')
   end subroutine begin_dxf

   !> Ends a file: its section and itself.
   subroutine end_dxf(o)
      type(output_t), intent(inout) :: o

      call write_pair(o, 0, 'ENDSEC')
      call write_pair(o, 0, 'EOF')
   end subroutine end_dxf

   !> Writes the entities of a set. Layers of the first set of the file have no number.
   subroutine write_dxf(o, drawing, paths, number)
      type(output_t), intent(inout) :: o
      type(drawing_t), intent(in) :: drawing   !< of the set; the first frame is the first instant
      type(point_path_t), intent(in) :: paths(:)   !< (any number) of the set
      integer, intent(in) :: number          !< of the set in the file, from 1
      character(:), allocatable :: layer
      real(wp), allocatable :: p(:, :)
      integer :: i, k, n

      layer = ''
      if (number > 1) layer = whole(number)//'-'
      do i = 1, size(paths)
         call write_path(o, layer//'PATHS', paths(i), paths(1)%is_closed)
      end do
      associate (m => drawing%mechanism, s => drawing%frame(1))
         do i = 1, size(m%pairs)
            if (has_guide(m%pairs(i)%kind) .or. .not. s%known(m%points(m%pairs(i)%point_i)%link)) cycle
            call write_pair(o, 0, 'CIRCLE')
            call write_pair(o, 8, layer//'JOINTS')
            call write_place(o, 0, point_place(m, s, m%pairs(i)%point_i) + drawing%origin)
            call write_number(o, 40, circle_radius*characteristic_length(m))
         end do
         ! The sides of links; a bar has one.
         do i = 1, size(m%links)
            n = size(drawing%outlines(i)%corner, 2)
            if (m%links(i)%ground .or. n < 2 .or. .not. s%known(i)) cycle
            p = moved(drawing%outlines(i)%corner, s%place(:, i))
            do k = 1, merge(n, 1, n > 2)
               call write_side(o, layer, p(:, k) + drawing%origin, p(:, 1 + modulo(k, n)) + drawing%origin)
            end do
         end do
         ! Guides between the ends of the slide at this instant: from the foot to the block.
         do i = 1, size(drawing%guides)
            associate (g => drawing%guides(i))
               if (.not. (s%known(g%carrier) .and. s%known(g%block)) .or. g%low > g%high) cycle
               p = moved(reshape([g%foot, g%foot + g%low*direction(g%angle)], [2, 2]), s%place(:, g%carrier))
               call write_side(o, layer, p(:, 1) + drawing%origin, p(:, 2) + drawing%origin)
            end associate
         end do
      end associate
   end subroutine write_dxf

   !> Writes the pieces of a path on which its places are known. A piece of one place is not drawn.
   subroutine write_path(o, layer, path, closes)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: layer      !< name of the layer
      type(point_path_t), intent(in) :: path   !< of a point
      logical, intent(in) :: closes          !< the path is one closed piece, which has its first place only once
      integer :: first, last, k

      last = 0
      do
         first = last + findloc(path%known(last + 1:), .true., dim=1)
         if (first == last) exit
         last = first - 1 + findloc([path%known(first:), .false.], .false., dim=1) - 1
         if (closes) last = last - 1

         if (last > first) then
            call write_pair(o, 0, 'POLYLINE')
            call write_pair(o, 8, layer)
            call write_pair(o, 66, '1')
            call write_place(o, 0, [0.0_wp, 0.0_wp])
            call write_pair(o, 70, merge('1', '0', closes))
            do k = first, last
               call write_pair(o, 0, 'VERTEX')
               call write_pair(o, 8, layer)
               call write_place(o, 0, path%places(:, k))
            end do
            call write_pair(o, 0, 'SEQEND')
            call write_pair(o, 8, layer)
         end if
         if (closes) exit
      end do
   end subroutine write_path

   !> Writes a line on the layer of links.
   subroutine write_side(o, layer, p, corner)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: layer      !< the beginning of the layer's name: the number of the set, or ''
      real(wp), intent(in) :: p(2), corner(2)   !< ends of the line, lengths

      call write_pair(o, 0, 'LINE')
      call write_pair(o, 8, layer//'LINKS')
      call write_place(o, 0, p)
      call write_place(o, 1, corner)
   end subroutine write_side

   !> Writes a place of an entity: group codes 10, 20 and 30, or 11, 21 and 31.
   subroutine write_place(o, which, p)
      type(output_t), intent(inout) :: o
      integer, intent(in) :: which           !< 0: the first place of the entity; 1: the second
      real(wp), intent(in) :: p(2)           !< lengths

      call write_number(o, 10 + which, p(1))
      call write_number(o, 20 + which, p(2))
      call write_number(o, 30 + which, 0.0_wp)
   end subroutine write_place

   !> Writes a number with its group code, with `significant_digits`.
   subroutine write_number(o, code, value)
      type(output_t), intent(inout) :: o
      integer, intent(in) :: code            !< group code of DXF
      real(wp), intent(in) :: value          !< length

      call write_pair(o, code, rounded(value, significant_digits, 1.0e-3_wp, 1.0e9_wp))
   end subroutine write_number

   !> Writes a pair of DXF: a group code and its value.
   subroutine write_pair(o, code, value)
      type(output_t), intent(inout) :: o
      integer, intent(in) :: code            !< group code of DXF
      character(*), intent(in) :: value      !< as text

      call put(o, whole(code))
      call put(o, value)
   end subroutine write_pair
end module dxf
